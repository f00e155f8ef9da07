// A spinning box falls on a rough floor, tumbles over a corner and slides to rest on a face. At rest two corners stick: four contact forces for
// three degrees of freedom, a redundant contact.
//
//   tfc run falling_box.tf --event-log events.csv
model FallingBox "box with a contact on each corner"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real a(unit = "m") = 1 "width";
  parameter Real b(unit = "m") = 0.6 "height";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.2 "friction coefficient";
  parameter Real c[4, 2] = {{-a, -b}, {a, -b}, {a, b}, {-a, b}}/2 "corners in the frame of the box";
  coordinate Real r[2](start = {0, 1}, der(start = {3, 0}), each unit = "m") "centre of mass";
  coordinate Real phi(start = 0.9, der(start = 4), unit = "rad") "angle";
  Real corner[4, 2] = {r + {c[i, 1]*cos(phi) - c[i, 2]*sin(phi), c[i, 1]*sin(phi) + c[i, 2]*cos(phi)} for i in 1:4} "corners";
  body box(mass = m, position = r, angle = phi, inertia = m*(a^2 + b^2)/12);
  gravity weight(acceleration = {0, -g});
  contact floor[4](gap = corner[:, 2], slip = der(corner[:, 1]), each friction = mu);
  annotation(experiment(StopTime = 2, Tolerance = 1e-9));
end FallingBox;
