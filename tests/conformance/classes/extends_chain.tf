// expect: ok
model M
  model A
    parameter Real a = 1;
    Real x(start = a);
  equation
    der(x) = -x;
  end A;
  model B
    extends A(a = 2);
    Real y = 2*x;
  end B;
  extends B(x(nominal = 3));
  Real z = x + y;
end M;
