// expect: TF0438 at 11:26
// model: M
function gain
  input Real u;
  input Real factor = 1;
  output Real y;
algorithm
  y := factor*u;
end gain;
model M
  Real x = gain(time, 2, factor = 3);
end M;
