// expect: TF0420 at 3:16
model M
  Real x[2000, 2000];
end M;
