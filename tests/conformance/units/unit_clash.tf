// expect: TF0450 at 5:12
model M
  parameter Real m(unit = "kg") = 1;
  parameter Real l(unit = "m") = 2;
  Real x = m + l;
end M;
