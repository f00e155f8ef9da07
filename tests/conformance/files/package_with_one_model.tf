// expect: ok
package P
  constant Real k = 1;
  model M
    Real x = k*time;
  end M;
end P;
