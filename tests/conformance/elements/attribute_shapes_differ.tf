// expect: TF0311 at 5:14
model M
  coordinate Real q[2];
  body ball(mass = 1, position = q);
  force push(value = 3, at = q);
end M;
