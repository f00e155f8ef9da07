// A superball grips the floor: friction takes the slip of its lowest point in the impact, and spin and speed exchange, until it rolls while it
// bounces on. Thrown with backspin it comes back first. The bounces accumulate (Zeno), and then it rolls without bouncing.
//
//   tfc run superball.tf --event-log events.csv
//   tfc run superball.tf --set 'der(phi)=0'
model Superball "spinning ball on a rough floor"
  parameter Real m(unit = "kg") = 0.05 "mass";
  parameter Real R(unit = "m") = 0.025 "radius";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.6 "friction coefficient";
  parameter Real e(min = 0, max = 1) = 0.85 "coefficient of restitution";
  coordinate Real r[2](start = {0, 0.5}, der(start = {0.5, 0}), each unit = "m") "centre";
  coordinate Real phi(start = 0, unit = "rad", der(start = 90)) "angle, positive is backspin";
  Real mark[2] = r + R*{cos(phi), sin(phi)} "a mark on the ball";
  body ball(mass = m, position = r, angle = phi, inertia = 2/5*m*R^2);
  gravity weight(acceleration = {0, -g});
  contact floor(gap = r[2] - R, slip = der(r[1]) + R*der(phi), friction = mu, restitution = e, rate = m*g);
  annotation(experiment(StopTime = 5, Tolerance = 1e-9));
end Superball;
