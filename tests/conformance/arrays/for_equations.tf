// expect: ok
model M
  parameter Integer n = 3;
  Real x[n], y[n, n];
equation
  for i in 1:n loop
    x[i] = i*time;
  end for;
  for i, j loop
    y[i, j] = i + 10*j;
  end for;
end M;
