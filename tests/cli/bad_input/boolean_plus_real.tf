model BooleanPlusReal
  Boolean b = time > 1;
  Real x = b + 1;
end BooleanPlusReal;
