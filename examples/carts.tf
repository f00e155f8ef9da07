// Two carts on a track collide without rebound (restitution 0) and go on together until the buffer behind the second one
// throws the first one back. The contact opens by itself where its force falls to zero.
//
//   tfc run carts.tf --event-log events.csv
model Carts "plastic collision of two carts"
  parameter Real m[2](each unit = "kg") = {1, 3} "masses";
  parameter Real w(unit = "m") = 0.5 "length of a cart";
  parameter Real k(unit = "N/m") = 12 "stiffness of the buffer behind the second cart";
  coordinate Real x[2](start = {0, 1}, der(start = {2, 0}), each unit = "m") "positions";
  body cart[2](mass = m, position = x);
  potential buffer(energy = k*(x[2] - 1)^2/2);
  contact bumper(gap = x[2] - x[1] - w);
  annotation(experiment(StopTime = 3, Tolerance = 1e-9));
end Carts;
