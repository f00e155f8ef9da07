// expect: TF0206 at 6:12
model M
  package P
    constant Real k = 2;
  end P;
  Real x = P;
end M;
