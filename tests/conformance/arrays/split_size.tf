// expect: TF0412 at 7:20
model M
  model Part
    parameter Real k = 1;
    Real x = k*time;
  end Part;
  Part part[3](k = {1, 2});
end M;
