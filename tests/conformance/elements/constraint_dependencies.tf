// expect: TF0316 at 10:32
// expect: TF0316 at 11:32
// expect: TF0319 at 12:36
// expect: TF0317 at 13:32
// expect: TF0318 at 14:28
model M
  input Real u;
  coordinate Real x;
  body b(mass = 1, position = x);
  constraint c1(residual = x - u);
  constraint c2(residual = x - der(x));
  constraint c3(velocityResidual = der(x)^2 - 1);
  constraint c4(residual = x - c1.multiplier);
  constraint c5(residual = abs(x) - 1);
end M;
