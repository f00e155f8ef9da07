model MissingSemicolon
  parameter Real m = 1
  parameter Real k = 2;
end MissingSemicolon;
