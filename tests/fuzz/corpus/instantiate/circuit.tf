connector Pin
  Real v(unit = "V");
  flow Real i(unit = "A");
end Pin;
partial model OnePort
  Pin p, n;
  Real v, i;
equation
  v = p.v - n.v;
  0 = p.i + n.i;
  i = p.i;
end OnePort;
model Resistor
  extends OnePort;
  parameter Real R(unit = "Ohm") = 1;
equation
  v = R*i;
end Resistor;
model Capacitor
  extends OnePort(v(start = 1, fixed = true));
  parameter Real C = 1;
equation
  C*der(v) = i;
end Capacitor;
model Ground
  Pin p;
equation
  p.v = 0;
end Ground;
model Circuit
  replaceable Resistor r constrainedby OnePort;
  Capacitor c(C = 2);
  Ground g;
equation
  connect(r.p, c.p);
  connect(r.n, c.n);
  connect(c.n, g.p);
end Circuit;
