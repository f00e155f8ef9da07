model A
  Real x
equation
  x = 1 +;
  y = 2 * ;
  z = ;
  = 3;
  x + 1;
  x
end A
