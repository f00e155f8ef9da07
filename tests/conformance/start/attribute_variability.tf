// expect: TF0415 at 3:18
model M
  Real x(start = y);
  Real y = time;
equation
  der(x) = -x;
end M;
