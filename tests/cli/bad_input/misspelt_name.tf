model MisspeltName
  parameter Real stiffness = 2;
  Real x = stifness*time;
end MisspeltName;
