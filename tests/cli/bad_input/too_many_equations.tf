model TooManyEquations
  Real x;
equation
  x = time;
  x = 2*time;
end TooManyEquations;
