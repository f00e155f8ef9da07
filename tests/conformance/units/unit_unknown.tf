// expect: TF0451 at 3:18
model M
  parameter Real m(unit = "kgs") = 1;
end M;
