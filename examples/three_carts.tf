// Three carts on a rough track, the middle one driven: it is pushed against the right cart, then pulled back against the left one. The collisions
// are plastic; friction stops the carts that are left alone, and holds them against forces below its bound.
//
//   tfc run three_carts.tf --event-log events.csv
model ThreeCarts "a driven cart between two others"
  parameter Real m[3](each unit = "kg") = {1, 1, 1} "masses";
  parameter Real w(unit = "m") = 2 "length of a cart";
  parameter Real bound[3](each unit = "N") = {2, 2, 2} "dry friction";
  parameter Real push(unit = "N") = 12 "force on the middle cart before the turn";
  parameter Real pull(unit = "N") = 10 "force on it after the turn, to the left";
  parameter Real turn(unit = "s") = 1.5 "time of the turn";
  coordinate Real x[3](start = {-3, 0, 3}, each unit = "m") "positions";
  body cart[3](mass = m, position = x);
  force drive(value = if time < turn then push else -pull, at = x[2]);
  friction track[3](slip = der(x), bound = bound);
  contact bumper[2](gap = x[2:3] - x[1:2] - {w, w});
  annotation(experiment(StopTime = 5, Tolerance = 1e-9));
end ThreeCarts;
