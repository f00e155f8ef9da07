// expect: TF0401 at 3:15
model M
  Real x[2] = {1, 2} + {1, 2, 3};
end M;
