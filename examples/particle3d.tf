// A point mass falls on a rough plane while the wind pushes it: friction opposes the direction of the slip, which turns towards that of the wind
// until the mass is at rest, without creep.
// tfc run examples/particle3d.tf
model Particle3D "point mass sliding on a curve to rest on a rough plane"
  parameter Real mu = 0.2 "coefficient of friction";
  parameter Real g = 10;
  parameter Real wind = 1;
  coordinate Real q[3](start = {0, 0, 0.05}, der(start = {2, 2, 0}));
  body ball(mass = 1, position = q);
  force weight(value = {wind, 0, -g}, at = q);
  contact floor(gap = q[3], slip = {der(q[1]), der(q[2])}, friction = mu);
  annotation(experiment(StopTime = 4, Tolerance = 1e-9));
end Particle3D;
