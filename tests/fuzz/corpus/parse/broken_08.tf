model A
  Real x;
equations
  der(x) = 1;
end A;
