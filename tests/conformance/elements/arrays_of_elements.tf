// expect: ok
model M
  parameter Integer n = 4;
  coordinate Real q[n, 2](start = {{i, 1} for i in 1:n});
  body ball[n](each mass = 1, position = q);
  gravity g(acceleration = {0, -9.81});
  contact floor[n](gap = q[:, 2], slip = der(q[:, 1]), each friction = 0.3);
  Real total = sum(floor.normalForce) + floor[2].frictionForce;
end M;
