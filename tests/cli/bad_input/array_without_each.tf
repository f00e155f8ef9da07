model ArrayWithoutEach
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  contact wall[2](gap = q, friction = 0.3, each slip = der(q[1]));
end ArrayWithoutEach;
