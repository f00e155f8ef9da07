// expect: ok
model M
  parameter Real g = 9.81;
  coordinate Real q[2];
  body b(mass = 1, position = q);
  gravity weight(acceleration = {0, -g*(1 + 0.1*sin(time))});
end M;
