// expect: TF0137 at 4:21
model M
  parameter Real x[3] = {1, 2, 3};
  Real y = x[end] + end;
end M;
