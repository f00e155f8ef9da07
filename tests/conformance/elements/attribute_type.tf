// expect: TF0313 at 4:13
model M
  coordinate Real y(start = 1);
  body ball(mass = true, position = y);
end M;
