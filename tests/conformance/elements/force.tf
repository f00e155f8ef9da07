// expect: ok
model M
  input Real u;
  coordinate Real x, q[2];
  Real z(start = 0);
  body a(mass = 1, position = x);
  body b(mass = 1, position = q);
  force spring(value = -x - 0.1*der(x) + u + z, at = x);
  force push(value = {u, time}, at = q);
  force damper(at = q*q, value = -2*der(damper.at));
  Real p = spring.power;
equation
  der(z) = u - z;
end M;
