// expect: TF0436 at 3:12
model M
  Real x = atan2(time);
end M;
