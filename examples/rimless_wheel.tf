// The simplest walker: a wheel without a rim goes down a slope on its spokes. It turns about the foot that carries it until the next one hits
// the ground; that impact takes a share of the spin, the foot behind lifts off at the same instant. What the slope gives in a step is lost in
// the impact once the wheel has come to its own speed, fast or slow as it was at the start.
//
//   tfc run rimless_wheel.tf --event-log events.csv
//   tfc run rimless_wheel.tf --set n=12 --set slope=0.05
model RimlessWheel "spoked wheel on a slope"
  import Modelica.Constants.pi;
  parameter Integer n(min = 5) = 8 "number of spokes";
  parameter Real l(unit = "m") = 0.5 "length of a spoke";
  parameter Real m(unit = "kg") = 2 "mass";
  parameter Real J(unit = "kg.m2") = 0.1 "moment of inertia about the hub";
  parameter Real slope(unit = "rad") = 0.12 "angle of the slope";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 1.5 "friction coefficient";
  parameter Real w(unit = "rad/s") = 0.8 "angular velocity at the start, on an upright spoke";
  coordinate Real r[2](start = {0, l}, der(start = {l*w, 0}), each unit = "m") "hub, along the slope and off it";
  coordinate Real phi(start = 0, der(start = w), unit = "rad") "angle of the first spoke, clockwise";
  Real foot[n, 2] = {r - l*{sin(phi - 2*pi*k/n), cos(phi - 2*pi*k/n)} for k in 0:n - 1} "ends of the spokes";
  body wheel(mass = m, position = r, angle = -phi, inertia = J);
  gravity weight(acceleration = {g*sin(slope), -g*cos(slope)});
  contact ground[n](gap = foot[:, 2], slip = der(foot[:, 1]), each friction = mu);
  annotation(experiment(StopTime = 6, Tolerance = 1e-9));
end RimlessWheel;
