// expect: TF0226 at 3:21
model M
  Real x(start = 1, der(start = 2));
equation
  der(x) = -x;
end M;
