// expect: TF0214 at 4:8
model M
  parameter Real k = 1;
  Real k = 2;
end M;
