// expect: TF0205 at 6:3
model M
  parameter Real friction = 0.3;
  coordinate Real x;
  body ball(mass = 1, position = x);
  friction dry(slip = der(x), bound = 1);
end M;
