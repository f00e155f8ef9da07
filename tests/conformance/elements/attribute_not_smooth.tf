// expect: TF0318 at 5:24
model M
  coordinate Real x(start = 1), y(start = 1);
  body ball(mass = 1, position = {x, y});
  contact corner(gap = min(x, y));
end M;
