// expect: ok
model M
  Real a[3] = {1, 2, time};
  Real b[2, 2] = [a[1], 2; 3, 4];
  Real c[2, 3] = [b, {5, 6}];
  Real d[3, 2] = [b; 5, 6];
  Real e[2, 2] = {{i + 10*j for i in 1:2} for j in 1:2};
  Real f[3] = 1:3;
  Real g[5] = 0:0.25:1;
  Real h[4] = cat(1, {1}, a);
  Real k[2, 3] = {i*j for j in 1:3, i in 1:2};
end M;
