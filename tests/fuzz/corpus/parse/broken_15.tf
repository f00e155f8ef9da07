model A
  annotation(Icon());
  Real x;
equation
  parameter Real y = 3;
  Modelica.SI.Angle phi;
  while x < 1 loop
    x := 1;
  end while;
  x = a < b < c;
  x = a^b^c + 2*-3;
  x = f(a = 1, 2);
  x = end;
  x = {};
  x = f(1)(2);
  connect(a, b+1);
  connect(a);
end A;
