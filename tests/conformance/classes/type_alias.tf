// expect: ok
model M
  type Length = Real(quantity = "Length", unit = "m", min = 0);
  type Position = Length[3];
  parameter Real T(unit = "s") = 2;
  Length l(start = 1);
  Position p(each nominal = 2);
equation
  der(l) = -l/T;
  p = {1, 2, 3}*l;
end M;
