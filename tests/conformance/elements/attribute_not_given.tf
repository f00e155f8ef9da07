// expect: TF0306 at 6:18
model M
  coordinate Real y(start = 1);
  body ball(mass = 1, position = y);
  contact floor(gap = y);
  Real s = floor.slip;
end M;
