// expect: ok
model M
  coordinate Real x(start = 1, der(start = 2, fixed = true)), y(fixed = false, min = 0, nominal = 10);
  coordinate Real q[3](each start = 0, each unit = "m", der(each unit = "m/s"));
  body a(mass = 1, position = {x, y});
  body b(mass = 2, position = q);
end M;
