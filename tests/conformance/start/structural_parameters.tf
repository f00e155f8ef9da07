// expect: ok
model M
  parameter Integer n = 2*m;
  parameter Integer m = 2;
  parameter Real k = 3 annotation(Evaluate = true);
  Real x[n] = fill(k*time, n);
end M;
