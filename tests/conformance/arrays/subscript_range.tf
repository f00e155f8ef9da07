// expect: TF0423 at 4:14
model M
  parameter Real x[3] = {1, 2, 3};
  Real y = x[4];
end M;
