model A
  Real x = if a then b;
  Real y = 1 + if a then b else c;
  Real z(start = 1
  Real w;
  annotation(foo(x = );
end A;
