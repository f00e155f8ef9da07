// expect: ok
model M
  parameter Real k = 1;
  Real x = k*time;
equation
  assert(k > 0, "k must be positive, " + "it is not");
  assert(x < 100, "x is large", AssertionLevel.warning);
end M;
