// expect: TF0303 at 4:3
model M
  coordinate Real x;
  parameter body ball(mass = 1, position = x);
end M;
