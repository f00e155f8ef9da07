// expect: TF0225 at 5:26
model M
  coordinate Real y(start = 1);
  body ball(mass = 1, position = y);
  contact floor(gap = y, fricton = 0.3);
end M;
