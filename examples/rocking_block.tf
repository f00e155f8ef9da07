// Housner's rocking block: a tilted block falls back on its base and rocks from corner to corner. Every impact is inelastic, and yet there are
// infinitely many of them in finite time (Zeno without restitution): each takes a share of the spin, the next comes sooner. Friction keeps the
// corner that carries the block in place.
//
//   tfc run rocking_block.tf --event-log events.csv
model RockingBlock "block that rocks on its base"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real b(unit = "m") = 0.2 "half width";
  parameter Real h(unit = "m") = 0.6 "half height";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.8 "friction coefficient";
  parameter Real tilt(unit = "rad") = -0.2 "angle at the start: it stands on its right corner";
  coordinate Real r[2](start = {b - b*cos(tilt) - h*sin(tilt), -b*sin(tilt) + h*cos(tilt)}, each unit = "m") "centre of mass";
  coordinate Real phi(start = tilt, unit = "rad") "angle";
  Real corner[4, 2] = {r + {c[i, 1]*cos(phi) - c[i, 2]*sin(phi), c[i, 1]*sin(phi) + c[i, 2]*cos(phi)} for i in 1:4} "corners";
  body block(mass = m, position = r, angle = phi, inertia = m*(b^2 + h^2)/3);
  gravity weight(acceleration = {0, -g});
  contact floor[2](gap = corner[1:2, 2], slip = der(corner[1:2, 1]), each friction = mu);
protected
  parameter Real c[4, 2] = {{-b, -h}, {b, -h}, {b, h}, {-b, h}} "corners in the frame of the block";
  annotation(experiment(StopTime = 5, Tolerance = 1e-9));
end RockingBlock;
