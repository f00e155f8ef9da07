// expect: TF0216 at 6:3
model M
  partial model Part
    Real x;
  end Part;
  Part part;
end M;
