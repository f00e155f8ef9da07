// expect: TF0320 at 6:3
model M
  coordinate Real x;
  body ball(mass = 1, position = x);
equation
  der(der(x)) = -9.81;
end M;
