// expect: ok
model M
  model Spring
    parameter Real k = 1;
    Real f = -k*time;
  end Spring;
  model Stiff
    extends Spring(k = 100);
    Real extra = 1;
  end Stiff;
  model Holder
    replaceable Spring spring(k = 3);
  end Holder;
  Holder soft;
  Holder stiff(redeclare Stiff spring(extra = 2));
end M;
