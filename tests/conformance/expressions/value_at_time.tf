// expect: TF0138 at 4:18
model M
  Real x(start = 1);
  Real y = der(x)(2);
equation
  der(x) = -x;
end M;
