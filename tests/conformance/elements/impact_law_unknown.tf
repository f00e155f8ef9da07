// expect: TF0203 at 5:61
model M
  coordinate Real y(start = 1);
  body b(mass = 1, position = {0, y});
  contact floor(gap = y, restitution = 0.5, law = ImpactLaw.Moreau);
end M;
