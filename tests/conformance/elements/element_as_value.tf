// expect: TF0208 at 6:12
model M
  coordinate Real y(start = 1);
  body ball(mass = 1, position = y);
  contact floor(gap = y);
  Real n = floor;
end M;
