// expect: TF0315 at 5:26
model M
  coordinate Real y(start = 1);
  body ball(mass = 1, position = y);
  contact floor(gap = y, restitution = 1.5);
end M;
