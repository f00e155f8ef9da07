// expect: TF0421 at 4:12
model M
  parameter Integer n = 0;
  Real x = min(i*time for i in 1:n);
end M;
