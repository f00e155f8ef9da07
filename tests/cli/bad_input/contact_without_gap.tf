model ContactWithoutGap
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  contact floor(slip = der(q[1]), friction = 0.3);
end ContactWithoutGap;
