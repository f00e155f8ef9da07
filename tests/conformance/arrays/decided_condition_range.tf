// expect: TF0423 at 5:38
model M "behind a condition on a parameter, which may change, both values are needed"
  parameter Integer k = 1;
  parameter Real x[3] = {1, 2, 3};
  Real y = if k > 1 then x[1] else x[0];
end M;
