// expect: TF0211 at 5:14
package P
  parameter Real k = 2;
  model M
    Real x = k*time;
  end M;
end P;
