// expect: TF0220 at 4:16
model M
  model Part
    outer Real temperature;
    Real x = 2*temperature;
  end Part;
  Part part;
end M;
