model ParameterFromVariable
  Real x = time;
  parameter Real p = 2*x;
end ParameterFromVariable;
