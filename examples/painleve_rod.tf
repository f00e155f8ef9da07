// Painlevé's paradox: a rod slides fast over a rough floor on its end. Friction turns the end into the floor faster than any normal force lifts
// it: the contact forces have no solution. What happens is a frictional impulse, an impact without approach: it stops the slip at once, and the
// rod leaves the floor. Event kind `painleve`.
//
//   tfc run painleve_rod.tf --event-log events.csv
model PainleveRod "rod that slides on its end"
  import Modelica.Constants.pi;
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real l(unit = "m") = 1 "length";
  parameter Real J(unit = "kg.m2") = m*l^2/32 "inertia: more mass in the middle than a uniform rod";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 1 "friction coefficient";
  parameter Real e(min = 0, max = 1) = 0 "coefficient of restitution";
  parameter Real psi(unit = "rad") = pi/3 "angle against the floor at the start";
  coordinate Real r[2](start = {0, l/2*sin(psi)}, der(start = {-10, 0}), each unit = "m") "centre of mass";
  coordinate Real phi(start = psi, unit = "rad") "angle against the floor";
  Real tip[2, 2] = {r - l/2*{cos(phi), sin(phi)}, r + l/2*{cos(phi), sin(phi)}} "ends";
  body rod(mass = m, position = r, angle = phi, inertia = J);
  gravity weight(acceleration = {0, -g});
  contact floor[2](gap = tip[:, 2], slip = der(tip[:, 1]), each friction = mu, each restitution = e);
  annotation(experiment(StopTime = 0.2, Tolerance = 1e-9));
end PainleveRod;
