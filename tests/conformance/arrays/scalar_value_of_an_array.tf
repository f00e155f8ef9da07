// expect: TF0409 at 3:15
model M
  Real d[3] = 1;
  Real e[2](start = {1, 2}) = d[1:2];
end M;
