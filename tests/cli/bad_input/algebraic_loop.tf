model AlgebraicLoop
  Real x, y;
equation
  x = cos(y);
  y = sin(x) + time;
end AlgebraicLoop;
