model MasslessCoordinate
  coordinate Real x, y;
  body cart(mass = 1, position = x);
  force spring(value = -y, at = y);
end MasslessCoordinate;
