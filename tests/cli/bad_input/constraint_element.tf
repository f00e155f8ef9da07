model ConstraintElement
  coordinate Real q[2];
  body bob(mass = 1, position = q);
  constraint rod(residuum = q*q - 1);
end ConstraintElement;
