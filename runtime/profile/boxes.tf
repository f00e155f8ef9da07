// Several boxes in space fall on a rough floor and stay there: what many bodies do that do not touch each other.
model Dice
  parameter Integer n = 4;
  parameter Real h = 0.1, mu = 0.5;
  parameter Real s[8, 3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
  Die die[n](p(start = {{i, 0, 0.3 + 0.05*i} for i in 1:n}), Q(w(start = {{i, 2*i, 1} for i in 1:n})), each h = h, each mu = mu, each s = s);
  gravity weight(acceleration = {0, 0, -9.81});
end Dice;
model Die
  parameter Real h, mu, s[8, 3];
  coordinate Real p[3];
  coordinate Rotation Q;
  Real corner[8, 3] = {p + Q*(h*s[i, :]) for i in 1:8};
  body b(mass = 1, position = p, orientation = Q, inertia = 2/3*h^2*identity(3));
  contact floor[8](gap = corner[:, 3], slip = der(corner[:, 1:2]), each friction = mu);
end Die;
