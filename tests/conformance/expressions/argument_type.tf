// expect: TF0440 at 3:21
model M
  Real x[3] = cross({1, 2}, {1, 2, 3});
end M;
