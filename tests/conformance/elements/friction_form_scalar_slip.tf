// expect: TF0326 at 5:63
model M
  coordinate Real q[2](start = {0, 1});
  body b(mass = 1, position = q);
  contact floor(gap = q[2], slip = der(q[1]), friction = 0.2, frictionForm = FrictionForm.Polyhedral);
end M;
