// expect: TF0322 at 5:33
model M
  coordinate Real x;
  body b(mass = 1, position = x);
  constraint wire(residual = x, velocityResidual = der(x));
end M;
