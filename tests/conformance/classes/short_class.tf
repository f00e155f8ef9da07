// expect: ok
model M
  model A
    parameter Real k = 1;
    Real x = k*time;
  end A;
  model B = A(k = 5) "an A with another k";
  B b;
  B c(k = 6);
end M;
