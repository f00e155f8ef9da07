// expect: TF0309 at 4:8
model M
  coordinate Real y(start = 1);
  body ball(mass = 1);
end M;
