// expect: ok
model M
  constant ImpactLaw rigid = ImpactLaw.Newton;
  parameter Real e[3](each min = 0, each max = 1) = {0.2, 0.5, 1};
  coordinate Real y[3](each start = 1);
  body b[3](each mass = 1, position = {{0, y[i]} for i in 1:3});
  contact poisson(gap = y[1], restitution = e[1], law = ImpactLaw.Poisson);
  contact stronge(gap = y[2], restitution = e[2], law = ImpactLaw.Stronge);
  contact newton(gap = y[3], restitution = e[3], law = rigid);
end M;
