// expect: TF0452 at 3:18
model M
  parameter Real k;
  Real x = k*time;
end M;
