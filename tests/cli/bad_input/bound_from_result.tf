model BoundFromResult
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  contact floor(gap = q[2]);
  friction dry(slip = der(q[1]), bound = 0.3*floor.normalForce);
end BoundFromResult;
