// expect: TF0310 at 5:26
model M
  coordinate Real x, y(start = 1);
  body ball(mass = 1, position = {x, y});
  contact floor(gap = y, friction = 0.3);
end M;
