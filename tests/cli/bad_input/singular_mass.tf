model SingularMass
  coordinate Real x, y;
  body cart(mass = 1, position = x + y);
end SingularMass;
