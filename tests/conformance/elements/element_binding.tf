// expect: TF0304 at 5:35
model M
  coordinate Real x;
  body ball(mass = 1, position = x);
  force push(value = 1, at = x) = 2;
end M;
