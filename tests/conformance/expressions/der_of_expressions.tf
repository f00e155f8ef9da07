// expect: ok
model M
  coordinate Real q[2];
  Real z(start = 1);
  body b(mass = 1, position = q);
  Real r = q[1]*sin(q[2]) + z;
  Real a[2] = der(q), c = der(q[1]*q[2]), d = der(r), e = der(time^2), f = der(3), g[2] = der(q .* q);
equation
  der(z) = -z;
end M;
