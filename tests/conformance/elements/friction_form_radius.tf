// expect: TF0315 at 5:102
model M
  coordinate Real q[3](start = {0, 0, 1});
  body b(mass = 1, position = q);
  contact floor(gap = q[3], slip = der(q[1:2]), friction = 0.2, frictionForm = FrictionForm.Relaxed, slipRadius = 0);
end M;
