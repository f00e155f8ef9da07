// A Filippov system without any mechanics: the relay drives x to the surface x = 0, where the solution slides. The same surface switches both
// equations, so on it der(z) takes the mean value cos(time)/2.
//
//   tfc run relay.tf
//   tfc compile relay.tf --emit step
model Relay "sliding on the surface of a relay"
  parameter Real k = 1 "amplitude of the disturbance";
  Real x(start = 1, fixed = true), z(start = 0, fixed = true);
equation
  der(x) = -2*sign(x) + k*cos(time);
  der(z) = if x > 0 then 1 else -1;
  annotation(experiment(StopTime = 3, Tolerance = 1e-9));
end Relay;
