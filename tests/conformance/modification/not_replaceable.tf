// expect: TF0223 at 9:32
model M
  model Part
    parameter Real k = 1;
  end Part;
  model Holder
    Part part;
  end Holder;
  Holder holder(redeclare Part part(k = 2));
end M;
