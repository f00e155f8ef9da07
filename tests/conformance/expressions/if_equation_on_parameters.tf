// expect: ok
model M "a condition that is known selects a branch, which may have another number of equations"
  parameter Boolean isFast = true;
  Real x(start = 1);
equation
  if isFast then
    der(x) = -10*x;
  else
    der(x) = -x;
    assert(x > 0, "x is positive");
  end if;
end M;
