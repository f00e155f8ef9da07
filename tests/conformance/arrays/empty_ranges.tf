// expect: ok
// Of a chain with one link: everything between links is an array without elements.
model M
  model Link
    coordinate Real x[2];
    body b(mass = 1, position = x);
    contact c(gap = x[2]);
  end Link;
  parameter Integer n = 1;
  coordinate Real x[n];
  body b[n](each mass = 1, position = x);
  Real stretch[n - 1] = {x[i + 1] - x[i] for i in 1:n - 1};
  Real table[n - 1, n] = {x[i]*x[j + 1] for i in 1:n, j in 1:n - 1};
  Real pairs[n - 1, 2] = {{x[i], x[i + 1]} for i in 1:n - 1};
  force spring[n - 1](value = {-10*(x[i + 1] - x[i]) for i in 1:n - 1}, at = stretch);
  contact c[n - 1](gap = {x[i + 1] - x[i] for i in 1:n - 1});
  Link link[n - 1];
  Real total[2] = {time, 1} + sum({x[i], x[i + 1]} for i in 1:n - 1);
  Real largest = max(cat(1, {x[1]}, {x[i + 1] for i in 1:n - 1}));
  Real forces = time + sum(c.normalForce) + sum(link.c.normalForce) + sum(link.x);
  Real path[n - 1, 2, 3] = {{{x[i], x[i + 1], k} for k in 1:2} for i in 1:n - 1};
  Real ends[n - 1, 2] = {{path[i, k, 3] for k in 1:2} for i in 1:n - 1};
  Real places[n - 1, 2] = {link[i].x for i in 1:n - 1};
  Real heights[n - 1] = {link[i].x[2] for i in 1:n - 1};
  Real lengths[n - 1] = link.x[1];
  Real filled[n - 1] = fill(x[1], n - 1);
end M;
