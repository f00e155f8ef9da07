// expect: TF0407 at 5:3
model M
  Real x[2](start = {0, 0});
equation
  der(x) = {1, 2, 3};
end M;
