// expect: TF0437 at 11:23
// model: M
function gain
  input Real u;
  input Real factor = 1;
  output Real y;
algorithm
  y := factor*u;
end gain;
model M
  Real x = gain(time, facter = 2);
end M;
