// expect: ok
model M
  coordinate Real x;
  body b(mass = 1, position = x);
  force f(value = -x, at = x);
  output Real v = der(x);
  output Real a = der(der(x));
  Real b2;
equation
  b2 = der(v);
end M;
