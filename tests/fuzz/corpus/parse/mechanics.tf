model Particle "point mass above a rough floor"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real mu(min = 0) = 0 "friction coefficient";
  input Real u[2](each unit = "N") "applied force";
  coordinate Real q[2](start = {0, 1}, der(start = {0, 0})) "position";
  body ball(mass = m, position = q);
  gravity weight(acceleration = {0, -g});
  force thrust(value = u, at = q);
  contact floor[2](gap = q, slip = {der(q[1]), 0}, each friction = mu, law = ImpactLaw.Poisson);
  .friction dry(slip = der(q[1]), bound = 2);
  constraint rod(residual = q*q - 1);
  annotation(experiment(StopTime = 4, Tolerance = 1e-9));
end Particle;
