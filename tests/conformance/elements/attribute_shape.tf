// expect: TF0312 at 7:23
model Particle
  parameter Real m = 1;
  coordinate Real q[2](start = {0, 1}) "position";

  // a matrix is not a position
  body ball(mass = m, position = {q, q});
end Particle;
