// expect: ok
model M
  parameter Real l = 1;
  coordinate Real phi;
  Real s = sin(phi), c = cos(phi);
  Real tip[2] = {l*s, -l*c};
  body bob(mass = 1, position = tip);
  contact wall(gap = 0.5 - tip[1], slip = der(tip[2]), friction = 0.1);
end M;
