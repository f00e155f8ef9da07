// expect: ok
package P
  package Q
    constant Real a = 1;
    constant Real b = 2;
    constant Real c = 3;
    constant Real d = 4;
  end Q;
end P;
model M
  import P.Q.a;
  import bee = P.Q.b;
  import P.Q.{c, d};
  model Inside
    import P.Q.*;
    Real x = a + d;
  end Inside;
  Inside inside;
  Real x = a + bee + c + d;
end M;
