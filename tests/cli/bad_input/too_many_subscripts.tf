model TooManySubscripts
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  Real x = q[1, 2];
end TooManySubscripts;
