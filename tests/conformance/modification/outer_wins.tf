// expect: ok
model M
  model A
    parameter Real k = 1;
    Real x(start = 1, min = 0, max = 1) = k*time;
  end A;
  model B
    A a(k = 2, x(start = 2));
  end B;
  B b(a(k = 3, x(max = 5)), a.x.nominal = 7);
end M;
