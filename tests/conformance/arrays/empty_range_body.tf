// expect: TF0201 at 4:20
model M
  parameter Integer n = 0;
  Real x[n] = {1 + y[i] for i in 1:n};
end M;
