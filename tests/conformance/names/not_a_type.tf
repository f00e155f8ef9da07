// expect: TF0215 at 6:3
package P
  constant Real k = 1;
end P;
model M
  P p;
end M;
