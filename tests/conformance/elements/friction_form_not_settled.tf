// expect: TF0325 at 6:50
model M
  coordinate Real q[3](start = {0, 0, 1});
  body b(mass = 1, position = q);
  contact floor[2](gap = {q[3], q[3]}, each slip = der(q[1:2]), each friction = 0.2,
    each frictionForm = FrictionForm.Polyhedral, directions = {4, 8});
end M;
