model M
  parameter Integer n = 4;
  Real x[n*(n - 1)/2];
  parameter Integer half = (n + 1)/2;
  Real y[4] = fill(time, 4);
  Real z = y[n/2];
  Real w[2.5/n];
end M;
