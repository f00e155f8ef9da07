model A
  Real x y;
  Real z;
equation
  x := 1;
  z == 3;
end B;
