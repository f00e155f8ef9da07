// expect: TF0224 at 6:13
model M
  model Part
    parameter Real stiffness = 1;
  end Part;
  Part part(stifness = 2);
end M;
