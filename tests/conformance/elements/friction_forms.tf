// expect: ok
model M
  parameter Integer n = 6;
  parameter FrictionForm form = FrictionForm.Relaxed annotation(Evaluate = true);
  parameter Real radius(min = 0) = 1e-3;
  coordinate Real q[3](start = {0, 0, 1});
  body b(mass = 1, position = q);
  contact exact(gap = q[3], slip = der(q[1:2]), friction = 0.2, frictionForm = FrictionForm.Exact);
  contact polygon(gap = q[3] + 1, slip = der(q[1:2]), friction = 0.2, frictionForm = FrictionForm.Polyhedral, directions = n);
  contact relaxed[2](gap = {q[3] + 2, q[3] + 3}, each slip = der(q[1:2]), each friction = 0.2, each frictionForm = form,
                     each slipRadius = radius);
  friction square(slip = der(q[1:2]), bound = 2, frictionForm = if n > 4 then FrictionForm.Polyhedral else FrictionForm.Exact,
                  directions = 2);
  Real f[2] = polygon.frictionForce + square.force;
  Integer d = polygon.directions;
end M;
