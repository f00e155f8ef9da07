// expect: TF0409 at 3:15
model M
  Real x[3] = {1, 2};
end M;
