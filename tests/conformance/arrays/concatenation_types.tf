// expect: TF0406 at 4:22
model M
  Real a[2, 2] = [1, 2; 3, 4];
  Real b[3, 2] = [a; {{1, 2, 3}}];
end M;
