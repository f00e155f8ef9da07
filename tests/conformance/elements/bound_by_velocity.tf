// expect: ok
model M "bounds that depend on velocities, but not on the direction of their own slips"
  coordinate Real x, y;
  body a(mass = 1, position = x);
  body b(mass = 1, position = y);
  friction peaked(slip = der(x), bound = 1 + 2*exp(-(der(x)/0.1)^2));
  friction even(slip = der(x), bound = 1 + abs(der(x)));
  friction growing(slip = der(x), bound = if der(x) > 0 then 1 + der(x) else 1);
  friction other(slip = der(x), bound = if der(y) > 0 then 1 else 2);
  friction belt(slip = der(x) - 1, bound = if der(x) > 0 then 1 else 2);
  friction fast(slip = der(x), bound = if der(x) > 1 then 1 else 2);
end M;
