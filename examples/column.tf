// A column of n balls falls on the floor. The balls collide with the floor and with each other again and again, in ever shorter times at ever
// lower speeds, and come to rest on top of each other one by one (Zeno with several contacts).
//
//   tfc run column.tf --event-log events.csv
//   tfc run column.tf --set n=10 --stop-time 6
model Column "n balls above each other"
  parameter Integer n(min = 1) = 4 "number of balls";
  parameter Real m(unit = "kg") = 0.1 "mass of a ball";
  parameter Real R(unit = "m") = 0.05 "radius";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real e(min = 0, max = 1) = 0.6 "coefficient of restitution";
  coordinate Real y[n](start = {0.2 + (2*i - 1)*R + 0.01*i*i for i in 1:n}, each unit = "m") "heights of the centres";
  body ball[n](each mass = m, position = {{0, y[i]} for i in 1:n});
  gravity weight(acceleration = {0, -g});
  contact floor(gap = y[1] - R, restitution = e);
  contact touch[n - 1](gap = y[2:n] - y[1:n - 1] - 2*R*ones(n - 1), each restitution = e);
  annotation(experiment(StopTime = 4, Tolerance = 1e-9));
end Column;
