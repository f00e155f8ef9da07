model UnknownAttribute
  parameter Real m(minimum = 0) = 1;
  Real x = m*time;
end UnknownAttribute;
