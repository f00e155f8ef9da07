model GapOfVelocity
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  contact floor(gap = q[2] + der(q[2]));
end GapOfVelocity;
