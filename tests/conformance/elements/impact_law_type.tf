// expect: TF0313 at 5:45
model M
  coordinate Real y(start = 1);
  body b(mass = 1, position = {0, y});
  contact floor(gap = y, restitution = 0.5, law = 2);
end M;
