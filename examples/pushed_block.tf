// A block on a rough floor is pushed by a force that swings to and fro: it sticks until the force beats the friction, slips, stops and sticks
// again, in both directions.
//
//   tfc run pushed_block.tf --event-log events.csv
model PushedBlock "stick, slip, stick under a swinging force"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.4 "friction coefficient";
  parameter Real F(unit = "N") = 6 "amplitude of the force";
  parameter Real w(unit = "rad/s") = 2 "its angular frequency";
  coordinate Real q[2](start = {0, 0}, each unit = "m") "position";
  body block(mass = m, position = q);
  gravity weight(acceleration = {0, -g});
  force push(value = F*sin(w*time), at = q[1]);
  contact floor(gap = q[2], slip = der(q[1]), friction = mu);
  annotation(experiment(StopTime = 5, Tolerance = 1e-9));
end PushedBlock;
