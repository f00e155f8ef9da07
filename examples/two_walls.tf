// A puck slides between two walls without friction. Each impact takes the share 1 - e of its speed, which never becomes zero: the time between
// impacts grows as a geometric series, and the puck goes to and fro for ever. The walls have different coefficients of restitution.
//
//   tfc run two_walls.tf --event-log events.csv
model TwoWalls "puck between two walls"
  parameter Real m(unit = "kg") = 0.2 "mass";
  parameter Real d(unit = "m") = 1 "distance of the walls";
  parameter Real e[2] = {0.9, 0.7} "coefficients of restitution";
  coordinate Real x(start = 0.5, unit = "m", der(start = 2)) "position";
  body puck(mass = m, position = {x, 0});
  contact wall[2](gap = {x, d - x}, restitution = e);
  annotation(experiment(StopTime = 10, Tolerance = 1e-9));
end TwoWalls;
