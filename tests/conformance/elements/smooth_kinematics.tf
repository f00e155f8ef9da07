// expect: ok
model M "a function that is twice differentiable although it is written with if"
  coordinate Real x, y(start = 1);
  Real bump = smooth(2, if x > 0 then x^4 else 0);
  body b(mass = 1, position = {x, y});
  contact floor(gap = y - bump, slip = der(x));
end M;
