model EquationWithoutSection
  Real x(start = 0);
  der(x) = 1;
end EquationWithoutSection;
