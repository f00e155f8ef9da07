// expect: TF0302 at 7:17
model M
  model Cart
    coordinate Real x(start = 1);
    body ball(mass = 1, position = x);
  end Cart;
  Cart cart(x = time);
end M;
