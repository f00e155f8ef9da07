// expect: TF0442 at 3:12
model M
  Real x = reinit(1, 2);
end M;
