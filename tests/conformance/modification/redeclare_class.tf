// expect: ok
model M
  model A
    Real x = 1;
  end A;
  model B
    parameter Real k = 1;
    Real x = k;
  end B;
  model Holder
    replaceable model Used = A;
    Used used[2];
  end Holder;
  Holder first;
  Holder second(redeclare model Used = B(k = 4));
  model Special
    extends Holder;
    redeclare model Used = B;
  end Special;
  Special special(used(k = {1, 2}));
end M;
