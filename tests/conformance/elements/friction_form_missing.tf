// expect: TF0308 at 5:65
model M
  coordinate Real q[3](start = {0, 0, 1});
  body b(mass = 1, position = q);
  contact floor(gap = q[3], slip = der(q[1:2]), friction = 0.2, slipRadius = 1e-3);
end M;
