model NoEquation
  Real x, y;
equation
  x = time;
end NoEquation;
