// expect: TF0410 at 3:32
model M
  coordinate Real q[2](start = 1);
  body ball(mass = 1, position = q);
end M;
