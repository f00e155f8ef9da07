// expect: ok
package P
  constant Real g = 9.81;
  package Q
    constant Real twice = 2*g;
    model M
      Real x = twice + g;
    end M;
  end Q;
end P;
