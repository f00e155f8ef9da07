// expect: TF0418 at 4:10
model M
  parameter Integer n = -2;
  Real x[n];
end M;
