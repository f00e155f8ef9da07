model Elements
  parameter Integer n = 2;
  parameter Real mu = 0.3;
  coordinate Real q[n](start = {0, 1}, each der(start = 0.5)), phi(start = 0.1);
  coordinate Real s(fixed = false);
  body b[2](each mass = 1, position = {{q[1], q[2]}, {q[1] + cos(phi), q[2] + sin(phi)}});
  body wheel(mass = 2, position = q, angle = phi, inertia = 0.1);
  gravity g(acceleration = {0, -9.81});
  potential spring(energy = 0.5*10*(q[1] - s)^2);
  force f(value = -der(s), at = s);
  contact c[2](gap = {q[2], q[1]}, slip = {der(q[1]), der(q[2])}, each friction = mu, rate = {1, 2});
  .friction dry(slip = der(phi), bound = 0.5);
  constraint rod(residual = q*q - 1);
  output Real load = c[1].normalForce;
end Elements;
