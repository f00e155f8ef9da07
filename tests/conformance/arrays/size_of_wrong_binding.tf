// expect: TF0408 at 4:25
model M
  parameter Integer n = 4;
  parameter Integer m = n*(n - 1)/2;
  final parameter Integer k = m + 1;
  Real x[m] = fill(time, m);
  Real y[k];
  Real z = sum(time for i in 1:k);
equation
  for i in 1:m loop
    y[i] = time;
  end for;
end M;
