// A particle is caught in the corner of two walls: two contacts close one after the other and stay closed.
//
//   tfc run corner.tf --event-log events.csv
model Corner "particle in the corner of two frictionless walls"
  parameter Real g(unit = "m/s2") = 10 "gravity";
  coordinate Real r[2](start = {0.8, 0.5}, der(start = {-1.5, -1}), each unit = "m") "position";
  body ball(mass = 1, position = r);
  gravity weight(acceleration = {0, -g});
  contact wall[2](gap = r);
  annotation(experiment(StopTime = 1.5, Tolerance = 1e-9));
end Corner;
