// expect: ok
model M
  Real x = -time^2 + 3*time/4 - 2^(-1);
  Boolean c = x > 1 and not time <= 2;
  Integer i = integer(time);
  Boolean d = i == 2 or i <> 3;
end M;
