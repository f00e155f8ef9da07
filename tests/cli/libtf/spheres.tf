// Six rough spheres in a corner of a room: slips of two components, rotations, and so many contacts that their derivatives are evaluated
// contact by contact.
model Spheres "spheres that touch one another and the room"
  parameter Integer n = 6;
  parameter Real radius = 0.2, mu = 0.4;
  coordinate Real p[n, 3](start = {{0.45*i, 0.3*mod(i, 3), 0.4 + 0.02*i} for i in 1:n});
  coordinate Rotation Q[n](w(start = {{0.1*i, 0.2, -0.1} for i in 1:n}));
  body ball[n](each mass = 0.5, position = p, orientation = Q, each inertia = 0.4*0.5*0.04*diagonal({1, 1.1, 0.9}));
  gravity weight(acceleration = {0, 0, -9.81});
  Real spin[n, 3] = {Q[i]*Q[i].w for i in 1:n};
  contact floor[n](gap = p[:, 3] - fill(radius, n), slip = {{der(p[i, 1]) - radius*spin[i, 2], der(p[i, 2]) + radius*spin[i, 1]} for i in 1:n},
    each friction = mu);
  contact wall[n](gap = p[:, 1] - fill(radius, n), slip = {{der(p[i, 2]) - radius*spin[i, 3], der(p[i, 3]) + radius*spin[i, 2]} for i in 1:n},
    each friction = mu);
  contact next[n - 1](gap = {sqrt((p[i + 1, :] - p[i, :])*(p[i + 1, :] - p[i, :])) - 2*radius for i in 1:n - 1});
end Spheres;
