// expect: ok
model M
  parameter Real size = 2, fastest = 3*size;
  parameter Boolean held = false;
  coordinate Real q(start = 1, min = -size, max = size, nominal = size, der(nominal = fastest, fixed = held));
  body b(mass = 1, position = q);
end M;
