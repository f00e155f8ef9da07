// expect: ok
model M
  parameter Real a = 2*b;
  parameter Real b = c + 1;
  parameter Real c = 3;
  parameter Real d(start = 4);
  Real x = a*time;
end M;
