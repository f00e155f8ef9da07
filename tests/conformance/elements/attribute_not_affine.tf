// expect: TF0319 at 5:33
model M
  coordinate Real x, y(start = 1);
  body ball(mass = 1, position = {x, y});
  contact floor(gap = y, slip = der(x)^2, friction = 0.3);
end M;
