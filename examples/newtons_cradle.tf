// Newton's cradle: balls on strings, a hair apart so that they collide one pair after the other. With e = 1 the speed of the first ball passes
// through the row and only the last one swings out. Without the gaps all contacts share one impact, which is another motion: --set space=0.
//
//   tfc run newtons_cradle.tf --event-log events.csv
//   tfc run newtons_cradle.tf --set e=0.9 --stop-time 10
model NewtonsCradle "row of pendulums that touch at rest"
  parameter Integer n(min = 2) = 5 "number of balls";
  parameter Real m(unit = "kg") = 0.1 "mass of a ball";
  parameter Real R(unit = "m") = 0.02 "radius";
  parameter Real l(unit = "m") = 0.3 "length of the strings";
  parameter Real space(unit = "m") = 1e-6 "gap between neighbours at rest";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real e(min = 0, max = 1) = 1 "coefficient of restitution";
  coordinate Real phi[n](start = {if i == 1 then -0.4 else 0 for i in 1:n}, each unit = "rad") "angles of the strings";
  Real centre[n, 2] = {{(2*R + space)*i + l*sin(phi[i]), -l*cos(phi[i])} for i in 1:n} "centres";
  body ball[n](each mass = m, position = centre);
  gravity weight(acceleration = {0, -g});
  contact touch[n - 1](gap = {sqrt((centre[i + 1, 1] - centre[i, 1])^2 + (centre[i + 1, 2] - centre[i, 2])^2) - 2*R for i in 1:n - 1}, each restitution = e);
  annotation(experiment(StopTime = 3, Tolerance = 1e-9));
end NewtonsCradle;
