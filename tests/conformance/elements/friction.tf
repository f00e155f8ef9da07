// expect: ok
model M
  coordinate Real x;
  body b(mass = 1, position = x);
  friction dry(slip = der(x) - 0.3, bound = 2 + 0.1*der(x)^2);
  Real f = dry.force;
  Boolean s = dry.sticking;
end M;
