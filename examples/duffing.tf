// Stick-slip with a hardening spring and a belt whose speed swings. No phase of it has a closed form, so it serves to measure the order of the
// integrator across switches (docs/order.svg).
//
//   tfc run duffing.tf --stages 3 --fixed-step 0.05 --event-log events.csv
model Duffing "mass on a hardening spring, dragged by a belt of varying speed"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real k = 1 "linear stiffness", k3 = 1 "cubic stiffness";
  parameter Real bound(unit = "N") = 1 "friction force in slip";
  parameter Real speed(unit = "m/s") = 0.6 "mean speed of the belt";
  parameter Real w(unit = "rad/s") = 2 "angular frequency of its variation";
  Real belt = speed*(1 + 0.7*sin(w*time)) "speed of the belt";
  coordinate Real x(start = -0.2, der(start = 0), unit = "m") "position";
  body mass(mass = m, position = x);
  potential spring(energy = k*x^2/2 + k3*x^4/4);
  friction dry(slip = der(x) - belt, bound = bound);
  annotation(experiment(StopTime = 6.5, Tolerance = 1e-9));
end Duffing;
