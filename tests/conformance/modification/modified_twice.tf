// expect: TF0221 at 3:29
model M
  Real x(start = 1, start = 2);
equation
  der(x) = -x;
end M;
