// expect: TF0238 at 6:12
model M
  model Part
    parameter Real k = 1;
  end Part;
  Part p = 2;
end M;
