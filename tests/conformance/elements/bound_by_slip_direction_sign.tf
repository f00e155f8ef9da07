// expect: TF0619 at 7:46
model M
  coordinate Real x;
  parameter Real belt = 0.3;
  Real slip = 2*(belt - der(x)), rough;
  body block(mass = 1, position = x);
  friction dry(slip = der(x) - belt, bound = rough);
equation
  rough = 2 + sign(slip);
end M;
