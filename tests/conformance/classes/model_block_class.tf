// expect: ok
package P
  block Gain "a block has inputs and outputs"
    input Real u;
    parameter Real k = 2;
    output Real y = k*u;
  end Gain;
  class Plain
    Real x = 1;
  end Plain;
end P;
model M
  P.Gain gain(u = time);
  P.Plain plain;
end M;
