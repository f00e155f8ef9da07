// expect: TF0241 at 12:32
model M
  model Spring
    parameter Real k = 1;
  end Spring;
  model Stiff
    extends Spring(k = 100);
  end Stiff;
  model Holder
    replaceable Spring spring[3];
  end Holder;
  Holder stiff(redeclare Stiff spring[3, 2]);
end M;
