// expect: ok
model M
  Real x(start = 1), y;
equation
  if x > 0.5 then
    der(x) = -1;
    y = 1;
  else
    der(x) = -2;
    y = x;
  end if;
end M;
