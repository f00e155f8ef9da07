// expect: TF0207 at 7:14
model M
  model Part
    Real x = time;
  end Part;
  Part part;
  Real y = 2*part;
end M;
