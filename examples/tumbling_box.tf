// A box is thrown on a rough floor: it hits with one corner after the other, tumbles over them, falls on a face and slides to rest. Eight
// corners, each with friction in the plane; at rest four of them stick, twelve contact forces for six degrees of freedom.
//
//   tfc run tumbling_box.tf --event-log events.csv
model TumblingBox "box with a contact on each corner, in space"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real h[3](each unit = "m") = {0.3, 0.2, 0.15} "half edges";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.3 "friction coefficient";
  parameter Real e(min = 0, max = 1) = 0 "coefficient of restitution";
  coordinate Real p[3](start = {0, 0, 0.8}, der(start = {8, 0.3, 0}), each unit = "m") "centre";
  coordinate Rotation Q(start = {0.9, 0.2, -0.3, 0.1}, w(start = {0.5, 10, 2})) "orientation";
  Real corner[8, 3] = {p + Q*{s[i, k]*h[k] for k in 1:3} for i in 1:8} "corners";
  body box(mass = m, position = p, orientation = Q, inertia = m/3*diagonal({h[2]^2 + h[3]^2, h[1]^2 + h[3]^2, h[1]^2 + h[2]^2}));
  gravity weight(acceleration = {0, 0, -g});
  contact floor[8](gap = corner[:, 3], slip = der(corner[:, 1:2]), each friction = mu, each restitution = e);
protected
  parameter Real s[8, 3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}} "signs";
  annotation(experiment(StopTime = 4, Tolerance = 1e-9));
end TumblingBox;
