// expect: TF0219 at 3:18
model M
  parameter Real a = 2*b;
  parameter Real b = a + 1;
  Real x = a*time;
end M;
