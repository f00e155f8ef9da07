// expect: TF0403 at 3:15
model M
  Real x = if time then 1 else 2;
end M;
