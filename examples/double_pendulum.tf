// A double pendulum swings against a rough wall. Its lower end hits the wall without rebound, slides along it with friction and leaves it again.
// Between the impacts the motion is sensitive to its start, as that of every double pendulum.
//
//   tfc run double_pendulum.tf --event-log events.csv
model DoublePendulum "double pendulum against a wall"
  parameter Real m[2](each unit = "kg") = {1, 0.6} "masses of the rods";
  parameter Real l[2](each unit = "m") = {1, 0.8} "their lengths";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real wall(unit = "m") = 0.4 "position of the wall";
  parameter Real mu(min = 0) = 0.2 "friction coefficient";
  parameter Real e(min = 0, max = 1) = 0 "coefficient of restitution";
  coordinate Real phi[2](start = {-1, -0.3}, each unit = "rad") "angles from the vertical";
  Real joint[2] = l[1]*{sin(phi[1]), -cos(phi[1])} "lower end of the first rod";
  Real tip[2] = joint + l[2]*{sin(phi[2]), -cos(phi[2])} "lower end of the second rod";
  body rod[2](mass = m, position = {joint/2, (joint + tip)/2}, angle = phi, inertia = {m[i]*l[i]^2/12 for i in 1:2});
  gravity weight(acceleration = {0, -g});
  contact stop[2](gap = {wall - joint[1], wall - tip[1]}, slip = {der(joint[2]), der(tip[2])}, each friction = mu, each restitution = e);
  annotation(experiment(StopTime = 4, Tolerance = 1e-9));
end DoublePendulum;
