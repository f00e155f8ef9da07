model Empty
  Real a[0, 1] = {{i*j for j in 1:2} for i in 1:0};
  Real b[:] = {k for k in 3:1e-9:-2e9};
  Real c[:] = 1:-4e9;
  Real s = sum(a) + sum({i for i in 5:-7000000000});
end Empty;
