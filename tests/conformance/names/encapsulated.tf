// expect: ok
package P
  constant Real k = 2;
  encapsulated model M "sees predefined classes and imports only"
    import P.k;
    coordinate Real x;
    body b(mass = k, position = x);
  end M;
end P;
