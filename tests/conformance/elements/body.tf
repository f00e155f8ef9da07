// expect: ok
model M
  coordinate Real x, r[2], phi, h;
  body onLine(mass = 1, position = x);
  body inPlane(mass = 2, position = r, angle = phi, inertia = 0.1);
  body wheel(angle = 2*phi, inertia = 0.5);
  body inSpace(mass = 3, position = {x, r[1], h});
  Real energy = onLine.kineticEnergy + inPlane.kineticEnergy;
  Real v[2] = inPlane.velocity;
end M;
