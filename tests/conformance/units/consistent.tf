// expect: ok
model M
  parameter Real m(unit = "kg") = 1, g(unit = "m/s2") = 9.81, k(unit = "N/m") = 3;
  Real x(unit = "m", start = 1);
  Real v(unit = "m/s") = der(x);
  Real f(unit = "N") = m*g - k*x;
  Real e(unit = "J") = 0.5*m*v^2 + m*g*x;
equation
  der(x) = -2;
end M;
