model A
  Real in;
  parameter final Real q = 3;
  input parameter Real r;
  parameter constant Real s;
  coordinate Real q = 3;
  parameter coordinate Real z;
  each Real w;
  coordinate x;
  coordinate coordinate;
end A;
