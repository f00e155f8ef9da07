// expect: TF0443 at 5:3
model M
  Real x(start = 1);
equation
  if x > 0 then
    der(x) = -1;
  end if;
end M;
