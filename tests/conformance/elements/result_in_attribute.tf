// expect: TF0317 at 7:42
model M
  parameter Real mu = 0.3;
  coordinate Real x, y(start = 1);
  body ball(mass = 1, position = {x, y});
  contact floor(gap = y);
  friction dry(slip = der(x), bound = mu*floor.normalForce);
end M;
