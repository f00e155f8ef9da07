// expect: ok
model M
  parameter Real x0 = 2;
  Real x(start = x0, fixed = true), y(start = 2*x0 + 1, nominal = 10);
  coordinate Real q(start = x0, fixed = false, der(start = 1, fixed = true));
  body b(mass = 1, position = q);
equation
  der(x) = -x;
  der(y) = -y;
end M;
