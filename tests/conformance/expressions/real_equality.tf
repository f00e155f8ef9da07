// expect: TF0429 at 4:15
model M
  Real x = time;
  Boolean b = x == 1;
end M;
