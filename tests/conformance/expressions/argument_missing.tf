// expect: TF0439 at 11:12
// model: M
function gain
  input Real u;
  input Real factor;
  output Real y;
algorithm
  y := factor*u;
end gain;
model M
  Real x = gain(time);
end M;
