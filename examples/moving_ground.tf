// A particle lies on a table that swings up and down. Where the table falls away faster than gravity allows, the particle lifts off, flies and
// lands on the moving table with an impact. The gap depends on time: its explicit time derivatives are part of the contact.
//
//   tfc run moving_ground.tf --event-log events.csv
model MovingGround "particle on a swinging table"
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real A(unit = "m") = 0.1 "amplitude of the table";
  parameter Real w(unit = "rad/s") = 12 "its angular frequency";
  coordinate Real y(start = 0, der(start = A*w), unit = "m") "height of the particle";
  Real table = A*sin(w*time) "height of the table";
  body ball(mass = 1, position = {0, y});
  gravity weight(acceleration = {0, -g});
  contact surface(gap = y - table);
  annotation(experiment(StopTime = 1.5, Tolerance = 1e-9));
end MovingGround;
