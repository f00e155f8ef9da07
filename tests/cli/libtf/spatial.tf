model Spatial "rotations of all kinds, constraints, moving bases"
  parameter Real I[3, 3] = {{0.2, 0.01, 0}, {0.01, 0.3, 0.02}, {0, 0.02, 0.25}};
  input Real u;
  coordinate Real phi, s;
  coordinate Rotation R, Q[2];
  Real z(start = 1);
  Rotation hinge = rotation({1, 2, 2*s}, phi + 0.3*sin(time));
  Rotation arm = R*hinge;
  Real tip[3] = {s, 0.2*time^2, 0} + R*({0.1, 0.2, 0.3} + hinge*{0, s, 0.4});
  Real ball[3] = tip + arm*(inverse(Q[1])*{0.2, 0.1, -0.3});
  body first(mass = 1.5, position = tip, orientation = arm, inertia = I);
  body second(mass = 0.5, position = ball, orientation = Q[1]*Q[2], inertia = 0.1*identity(3));
  body third(orientation = Q[2], inertia = diagonal({0.3, 0.2, 0.4}));
  body weightless(angle = phi, inertia = 0.1);
  gravity weight(acceleration = {0.1*time, 0, -9.81});
  potential spring(energy = 0.5*(tip - ball)*(tip - ball)*(1 + 0.1*time) + z*s);
  force motor(value = {u, z, 0.3}, at = arm);
  force push(value = -0.2*der(ball) + {u, 0, 0}, at = ball + {0, time, 0});
  force damper(value = -0.1*Q[2].w, at = Q[2]);
  contact floor(gap = ball[3] - 0.1*sin(time), slip = der(ball[1:2]) - {0.3, time}, friction = 0.4);
  friction dry(slip = arm.w[1] + der(s), bound = 1);
  constraint joint(residual = {ball[1] - time^2, (Q[1]*{1, 0, 0})*(R*{0, 1, 0})});
  constraint rolling(velocityResidual = R.w[3] - Q[2].w[1]*s - 0.3*time);
equation
  der(z) = s - z;
end Spatial;
