// expect: ok
model M "the same element inherited twice is one (MLS 7.1)"
  model Base
    parameter Real k = 1;
    Real z(start = 1);
  equation
    der(z) = -k*z;
  end Base;
  model Left
    extends Base;
    Real l = k*time;
  end Left;
  model Right
    extends Base;
    Real r = k + time;
  end Right;
  extends Left;
  extends Right;
end M;
