// expect: TF0411 at 7:20
model M
  model Part
    parameter Real k = 1;
    Real x = k*time;
  end Part;
  Part part[2](k = 3);
end M;
