// expect: TF0426 at 3:15
model M
  Real x[3] = 1:0:3;
end M;
