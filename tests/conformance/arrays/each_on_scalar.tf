// expect: TF0413 at 3:23
model M
  Real x(each start = 1);
equation
  der(x) = -x;
end M;
