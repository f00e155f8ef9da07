model A
  Real x if;
  Real a b;
  extends B(break c, redeclare model X Real x; end X);
  Foo f(break c, der = 3, redeclare Real x, y);
  Real p = break;
end A;
