// expect: ok
model M
  model A
    final parameter Real k = 2;
    parameter Real l = 1;
    Real x = k*l;
  end A;
  A a(final l = 3);
end M;
