model GapWithoutCoordinate
  coordinate Real q[2](start = {0, 1});
  body ball(mass = 1, position = q);
  contact floor(gap = 1 - time);
end GapWithoutCoordinate;
