// expect: ok
model M
  model Cart
    coordinate Real x[2](start = {0, 1}, der(start = {1, 0}));
    body b(mass = 1, position = x);
  end Cart;
  Cart a(x(der(start = {2, 3})));
  Cart b[2](each x(each der(start = 1)));
  Cart c[2](x(start = {{1, 2}, {3, 4}}, der(start = {{5, 6}, {7, 8}})));
end M;
