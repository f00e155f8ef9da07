// expect: TF0416 at 5:31
// expect: TF0452 at 4:18
model M
  parameter Real size;
  coordinate Real q(nominal = size);
  body b(mass = 1, position = q);
end M;
