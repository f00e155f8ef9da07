model ElementAsValue
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  Real x = ball + 1;
end ElementAsValue;
