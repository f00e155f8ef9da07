// expect: ok
model M
  parameter Real l(unit = "m") = 2;
  parameter Real factor = 3;
  Real x(unit = "m") = l + 1;
  Real y(unit = "s") = factor*l;
  Real z(unit = "m") = if time > 1 then l else 0;
end M;
