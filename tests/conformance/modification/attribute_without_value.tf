// expect: TF0228 at 3:36
model M
  coordinate Real y(start = 1, der(start));
  body ball(mass = 1, position = y);
end M;
