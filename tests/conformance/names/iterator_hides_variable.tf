// expect: ok
model M
  Real i = time;
  Real x[3];
equation
  for i in 1:3 loop
    x[i] = i;
  end for;
end M;
