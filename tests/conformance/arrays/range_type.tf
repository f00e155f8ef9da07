// expect: TF0425 at 3:17
model M
  Real x[3] = 1:{3};
end M;
