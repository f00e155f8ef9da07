// expect: ok
model M
  coordinate Real q[3](start = {0, 0, 1});
  body b(mass = 1, position = q);
  contact floor(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = 0.2);
  Real t[2] = floor.frictionForce;
end M;
