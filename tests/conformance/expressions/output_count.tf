// expect: TF0445 at 11:3
// model: M
function swap
  input Real a, b;
  output Real c = b;
  output Real d = a;
end swap;
model M
  Real x, y, z;
equation
  (x, y, z) = swap(time, 1);
end M;
