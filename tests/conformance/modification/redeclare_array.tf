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
    parameter Integer n = 2;
    replaceable Spring spring[n](k = {1, 2});
    Real sum = spring[1].f + spring[2].f;
  end Holder;
  Holder kept(redeclare Stiff spring(extra = {2, 3}));
  Holder changed(redeclare Stiff spring[3](k = {1, 2, 3}));
  Real f = kept.spring[2].extra + changed.spring[3].f;
end M;
