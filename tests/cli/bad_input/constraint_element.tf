model ConstraintElement
  coordinate Real q[2];
  body bob(mass = 1, position = q);
  constraint rod(residual = q*q - 1);
end ConstraintElement;
