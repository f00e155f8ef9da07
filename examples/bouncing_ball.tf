// A ball bounces infinitely often in finite time (Zeno): each bounce keeps the share e of the speed, the bounces accumulate at
// t = t1 + 2 e v1/(g (1 - e)), and from then on the ball rests. The event log ends the impacts with a `rest` event at that instant.
//
//   tfc run bouncing_ball.tf --event-log events.csv
//   tfc run bouncing_ball.tf --set e=0.99 --stop-time 100
model BouncingBall "ball on a hard floor"
  parameter Real m(unit = "kg") = 0.5 "mass";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real e(min = 0, max = 1) = 0.8 "coefficient of restitution";
  coordinate Real y(start = 1, unit = "m") "height";
  body ball(mass = m, position = {0, y});
  gravity weight(acceleration = {0, -g});
  contact floor(gap = y, restitution = e, rate = m*g);
  annotation(experiment(StopTime = 5, Tolerance = 1e-9));
end BouncingBall;
