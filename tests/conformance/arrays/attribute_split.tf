// expect: TF0314 at 5:19
model M
  coordinate Real q[3](each start = 1);
  body ball(mass = 1, position = q);
  contact wall[2](gap = q);
end M;
