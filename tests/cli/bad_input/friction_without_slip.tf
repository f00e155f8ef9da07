model FrictionWithoutSlip
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  contact floor(gap = q[2], friction = 0.3);
end FrictionWithoutSlip;
