// expect: ok
model M
  model A
    Real y(start = 1, fixed = true), z[2](each fixed = true);
  equation
    der(y) = -y;
    der(z) = -z;
  end A;
  model Fixed
    A a[3](each y(nominal = 2), each z(start = {4, 5}));
  end Fixed;
  A one[3](y(start = {1, 2, 3}), each y(fixed = false), each y.nominal = 3);
  A other[3](each y(fixed = false), y(start = {1, 2, 3}), y.nominal = {1, 2, 3});
  Fixed fixed(a(y(start = {1, 2, 3}), z(nominal = {{1, 2}, {3, 4}, {5, 6}})));
end M;
