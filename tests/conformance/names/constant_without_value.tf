// expect: TF0212 at 6:12
package P
  constant Real k;
end P;
model M
  Real x = P.k*time;
end M;
