model AccelerationFixed
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
equation
  der(der(q[1])) = 1;
end AccelerationFixed;
