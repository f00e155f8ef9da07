// A pendulum swings against a wall, which stops it before it reaches its lowest point. Its weight holds it there until a gust takes it off; it
// comes back to the wall with an impact when the wind turns.
//
//   tfc run pendulum_wall.tf --event-log events.csv
model PendulumWall "pendulum against a wall"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real l(unit = "m") = 1 "length";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real wall(unit = "m") = -0.3 "position of the wall";
  parameter Real d(unit = "N.m.s/rad") = 0.05 "damping in the pivot";
  parameter Real gust(unit = "N") = 4 "strength of the wind";
  coordinate Real phi(start = -1.2, unit = "rad") "angle from the vertical";
  Real r[2] = l*{sin(phi), -cos(phi)} "position";
  body bob(mass = m, position = r);
  gravity weight(acceleration = {0, -g});
  force damper(value = -d*der(phi), at = phi);
  force wind(value = {gust*sin(2*time), 0}, at = r);
  contact stop(gap = wall - r[1]);
  annotation(experiment(StopTime = 5, Tolerance = 1e-9));
end PendulumWall;
