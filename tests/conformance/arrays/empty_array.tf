// expect: TF0421 at 3:12
model M
  Real x = max({i*time for i in 1:0});
end M;
