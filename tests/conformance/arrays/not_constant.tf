// expect: TF0416 at 4:10
model M
  Integer n;
  Real x[n];
equation
  n = 2;
end M;
