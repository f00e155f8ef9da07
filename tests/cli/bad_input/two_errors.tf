model TwoErrors
  Real x = time +;
  Real y = 3 * / 2;
  Real z = time;
end TwoErrors;
