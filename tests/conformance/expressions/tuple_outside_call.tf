// expect: TF0430 at 5:3
model M
  Real x, y;
equation
  (x, y) = {1, 2};
end M;
