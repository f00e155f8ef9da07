// A ball is thrown on a rough floor with spin about an axis across its way: friction, which opposes the slip of the lowest point, bends its path to
// a parabola and turns it back, until the slip ends. From then on it rolls straight, with 5/7 of the speed it had and 2/7 of what the spin gives.
//
//   tfc run backspin_ball.tf --event-log events.csv
model BackspinBall "ball with spin on a rough floor"
  parameter Real m(unit = "kg") = 0.17 "mass";
  parameter Real R(unit = "m") = 0.03 "radius";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.2 "friction coefficient";
  coordinate Real p[3](start = {0, 0, R + 0.05}, der(start = {1, 0, 0}), each unit = "m") "centre";
  coordinate Rotation Q(w(start = {40, -100, 20})) "orientation";
  Real w[3] = Q*Q.w "angular velocity in space";
  Real mark[3] = p + Q*{0, 0, R} "a mark on the ball";
  body ball(mass = m, position = p, orientation = Q, inertia = 2/5*m*R^2*identity(3));
  gravity weight(acceleration = {0, 0, -g});
  contact floor(gap = p[3] - R, slip = {der(p[1]) - R*w[2], der(p[2]) + R*w[1]}, friction = mu);
  annotation(experiment(StopTime = 3, Tolerance = 1e-9));
end BackspinBall;
