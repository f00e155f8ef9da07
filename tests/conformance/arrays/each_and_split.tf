// expect: ok
model M
  model A
    parameter Real k = 1, v[2] = {1, 2};
    Real x(start = 1, fixed = true);
  equation
    der(x) = -k*x;
  end A;
  A a[3](k = {1, 2, 3}, each v = {5, 6}, x(start = {7, 8, 9}, each nominal = 2));
  A b[2](v = {{1, 2}, {3, 4}});
end M;
