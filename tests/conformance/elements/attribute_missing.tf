// expect: TF0307 at 5:11
model M
  coordinate Real y(start = 1);
  body ball(mass = 1, position = y);
  contact floor(rate = 2);
end M;
