model A
  Real x;
equation
  x = 1
  der(x) = 2;
end A;
