// Stick-slip: a mass on a spring is dragged along by a belt until the spring is stronger than the friction, slips back and is caught again.
// The normal load is given, so the dry friction is a `friction` element with a bound, not a contact.
//
//   tfc run stickslip.tf --event-log events.csv
model StickSlip "mass on a spring, dragged by a moving belt"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real k(unit = "N/m") = 4 "stiffness";
  parameter Real N(unit = "N") = 2 "normal load";
  parameter Real mu(min = 0) = 0.5 "friction coefficient";
  parameter Real belt(unit = "m/s") = 0.3 "speed of the belt";
  coordinate Real x(start = 0, der(start = 0.3), unit = "m") "position";
  body mass(mass = m, position = x);
  force spring(value = -k*x, at = x);
  friction dry(slip = der(x) - belt, bound = mu*N);
  annotation(experiment(StopTime = 5, Tolerance = 1e-9));
end StickSlip;
