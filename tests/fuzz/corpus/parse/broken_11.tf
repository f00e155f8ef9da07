model A
  Real x = 1e;
  Real é = 3 != 4 && 5;
  Real 'abc = 2;
  Real '' = 3;
  String s = "\q";
  Real b = 1e999 + $x;
end A;
