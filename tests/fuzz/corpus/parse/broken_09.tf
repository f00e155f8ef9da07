model A
  Real x "unterminated;
  Real y "foo";
equation
  x = 1;
end A;
