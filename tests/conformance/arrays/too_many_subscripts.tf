// expect: TF0424 at 4:12
model M
  parameter Real x[3] = {1, 2, 3};
  Real y = x[1, 2];
end M;
