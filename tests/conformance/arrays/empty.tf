// expect: ok
model M
  parameter Integer n = 0;
  parameter Real x[n] = zeros(n);
  Real s = sum(x) + time;
end M;
