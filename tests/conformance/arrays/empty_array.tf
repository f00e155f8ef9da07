// expect: TF0421 at 3:16
model M
  Real x = sum({i*time for i in 1:0});
end M;
