// expect: ok
// model: M
function scale
  input Real u;
  input Real k = 1;
  output Real y;
algorithm
  y := k*u;
end scale;
function double = scale(k = 2);
model M
  Real x = double(time);
end M;
