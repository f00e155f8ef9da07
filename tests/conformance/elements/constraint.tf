// expect: ok
// language.md section 3: constraints of positions and of velocities, scalars, vectors and arrays; their multipliers.
model M
  coordinate Real x, y, th, q[2];
  body a(mass = 1, position = {x, y}, angle = th, inertia = 1);
  body b(mass = 1, position = q);
  constraint wire(residual = y - x^2 - 0.1*time);
  constraint joint(residual = q - {x + cos(th), y + sin(th)});
  constraint edge[2](velocityResidual = {der(x) - th*der(y), der(th) - 1});
  output Real force = wire.multiplier, both[2] = joint.multiplier, edges[2] = edge.multiplier;
end M;
