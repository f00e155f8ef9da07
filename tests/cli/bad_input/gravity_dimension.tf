model GravityDimension
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  gravity weight(acceleration = {0, 0, -9.81});
end GravityDimension;
