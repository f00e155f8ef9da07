model SizeNotConstant
  parameter Real n = 2.5;
  Real x[n];
end SizeNotConstant;
