// expect: TF0316 at 6:27
model M
  input Real lift;
  coordinate Real y(start = 1);
  body ball(mass = 1, position = y);
  contact floor(gap = y - lift);
end M;
