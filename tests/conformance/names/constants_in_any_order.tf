// expect: ok
package P
  constant Real a = 2*b;
  constant Real b = c + 1;
  constant Real c = 3;
end P;
model M
  Real x = P.a;
end M;
