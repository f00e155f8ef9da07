// A table on four feet is dragged by a force that grows and turns it. The loads of four feet are not unique: it stays as long as some forces
// within all friction cones hold it, then all feet slip, each in its own direction.
// tfc run examples/dragged_table.tf
model DraggedTable "four feet stick together, then slip and turn"
  parameter Real mu = 0.5 "coefficient of friction";
  parameter Real x[4] = {0.5, -0.5, -0.5, 0.5}, y[4] = {0.4, 0.4, -0.4, -0.4} "feet";
  coordinate Real q[3] "centre";
  coordinate Real psi, pitch, roll "small angles about the axes z, y and x";
  body top(mass = 2, position = q);
  body turning(inertia = 0.4, angle = psi);
  body pitching(inertia = 0.3, angle = pitch);
  body rolling(inertia = 0.3, angle = roll);
  force weight(value = {0, 0, -20}, at = q);
  force pull(value = {3*time, 4*time, 0}, at = q);
  force twist(value = 0.8*time, at = psi);
  force tip(value = 0.5*time, at = pitch);
  contact foot[4](gap = {q[3] + roll*y[i] - pitch*x[i] for i in 1:4},
    slip = {{der(q[1]) - der(psi)*y[i], der(q[2]) + der(psi)*x[i]} for i in 1:4}, each friction = mu);
  annotation(experiment(StopTime = 3, Tolerance = 1e-9));
end DraggedTable;
