// expect: TF0222 at 7:13
model M
  model Part
    final parameter Real k = 1;
    Real x = k*time;
  end Part;
  Part part(k = 2);
end M;
