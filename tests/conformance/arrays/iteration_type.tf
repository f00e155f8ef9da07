// expect: TF0427 at 5:12
model M
  Real x[3];
equation
  for i in 3 loop
    x[i] = i;
  end for;
end M;
