// expect: TF0210 at 9:17
model M
  model Part
    Real x = time;
  protected
    Real hidden = 2*x;
  end Part;
  Part part;
  Real y = part.hidden;
end M;
