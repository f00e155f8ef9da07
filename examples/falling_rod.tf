// A rod falls on its end. Friction reverses inside the impact, so the velocity after it depends on the impact law; then the other end hits the
// floor and the rod slides to rest. Inertia couples normal and tangential direction: J_n' M^-1 J_t is not zero.
//
//   tfc run falling_rod.tf --event-log events.csv
model FallingRod "uniform rod above a rough floor"
  import Modelica.Constants.pi;
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real l(unit = "m") = 1 "length";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.3 "friction coefficient";
  coordinate Real r[2](start = {0, l/2*sin(pi/4) + 0.5}, der(start = {2, 0}), each unit = "m") "centre of mass";
  coordinate Real phi(start = pi/4, unit = "rad") "angle against the floor";
  Real tip[2, 2] = {r - l/2*{cos(phi), sin(phi)}, r + l/2*{cos(phi), sin(phi)}} "ends";
  body rod(mass = m, position = r, angle = phi, inertia = m*l^2/12);
  gravity weight(acceleration = {0, -g});
  contact floor[2](gap = tip[:, 2], slip = der(tip[:, 1]), each friction = mu);
  annotation(experiment(StopTime = 1.5, Tolerance = 1e-9));
end FallingRod;
