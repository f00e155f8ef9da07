// expect: TF0308 at 4:13
model M
  coordinate Real y(start = 1);
  body ball(position = y);
end M;
