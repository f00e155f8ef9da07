// expect: TF0204 at 7:17
model M
  model Part
    parameter Real length = 1;
  end Part;
  Part part;
  Real x = part.lenght;
end M;
