// expect: ok
model M
  model A
    parameter Real k = 1;
    Real x[2] = {k, time};
  end A;
  A a[3](k = {1, 2, 3});
  Real first[3] = a.x[1], pair[2] = a[2].x, both[2, 2] = a[2:3].x, k[3] = a.k;
end M;
