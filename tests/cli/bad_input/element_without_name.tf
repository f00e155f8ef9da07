model M
  coordinate Real y(start = 1);
  body ball(mass = 1, position = {0, y});
  gravity(acceleration = {0, -9.81});
end M;
