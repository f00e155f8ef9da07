// The lecture's warm-up example: a point mass falls on a rough floor, slides, sticks and, if it is pulled upwards, lifts off again.
// With rate = m*g physical time runs at half speed while the particle rests: dt/dtau = 1/2.
//
//   tfc run particle.tf --set mu=0.6 --set 'u[1]=7' --set 'u[2]=if time < 1 then 0 else 2*g*(time-1)' -o particle.csv
//   tfc run particle.tf --set mu=0.3 --set g=10 --set 'u[1]=2' --set 'der(q[1])=1' --stop-time 2 --event-log events.csv
model Particle "point mass above a rough floor"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0 "friction coefficient";
  parameter Real e(min = 0, max = 1) = 0 "coefficient of restitution";
  input Real u[2](each unit = "N") "applied force";
  coordinate Real q[2](start = {0, 1}, der(start = {0, 0})) "position";
  body ball(mass = m, position = q);
  gravity weight(acceleration = {0, -g});
  force thrust(value = u, at = q);
  contact floor(gap = q[2], slip = der(q[1]), friction = mu, restitution = e, rate = m*g);
  annotation(experiment(StopTime = 4, Tolerance = 1e-8));
end Particle;
