// expect: ok
model M
  parameter Real mu = 0.3;
  coordinate Real x, y(start = 1);
  body b(mass = 1, position = {x, y});
  contact floor(gap = y - 0.1*sin(time), slip = der(x) - 1, friction = mu*(1 + time), restitution = 0.5, law = ImpactLaw.Newton, rate = 2);
  contact ceiling(gap = 5 - y);
  output Real n = floor.normalForce, t = floor.frictionForce, v = floor.slip, i = floor.impulse, g = floor.gap;
  Boolean closed = floor.closed, sticking = floor.sticking;
end M;
