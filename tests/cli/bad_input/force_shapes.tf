model ForceShapes
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  force push(value = {1, 2, 3}, at = q);
end ForceShapes;
