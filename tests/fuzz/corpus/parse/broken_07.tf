model A
  x = 1;
  der(y) = 2;
  Real z;
equations
  y = 3;
end A;
