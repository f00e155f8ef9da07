// expect: TF0441 at 3:12
model M
  Real x = sin(i for i in 1:3);
end M;
