// expect: ok
// language.md section 3: rotations as coordinates, composed, inverted, about an axis; what can be read of them.
model M
  parameter Real phi0 = 0.2;
  coordinate Rotation R(start = {1, 0, 0, 0}, w(start = {1, 2, 3}, each fixed = true));
  coordinate Rotation Q[2](each q(start = {0, 1, 0, 0}, fixed = true), w(start = {{0, 0, 1}, {1, 0, 0}}));
  coordinate Real phi;
  Rotation hinge = rotation({0, 0, 1}, phi + phi0);
  Rotation arm;
  Real tip[3] = arm*{1, 0, 0}, back[3] = inverse(arm)*tip;
  Real rate[3] = arm.w, velocity[3] = der(tip), w3 = R.w[3], acceleration[3] = der(R.w), qx = arm.q[2], first[3] = Q[1].w, both[2, 3] = Q.w;
  body top(position = tip, mass = 1, orientation = arm, inertia = identity(3));
  body chain[2](orientation = Q, each inertia = identity(3));
  body base(orientation = R, inertia = diagonal({2, 2, 1}));
  body wheel(angle = phi, inertia = 1);
  force motor(value = {0, 0, 1}, at = R);
  force damper(value = -Q[1].w, at = Q[1]*inverse(Q[2]));
  contact floor(gap = tip[3] + 2, slip = der(tip[1:2]), friction = 0.3);
equation
  arm = R*hinge;
end M;
