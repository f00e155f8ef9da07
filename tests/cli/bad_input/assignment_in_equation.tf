model AssignmentInEquation
  Real x;
equation
  x := time;
end AssignmentInEquation;
