// expect: TF0619 at 5:42
model M
  coordinate Real x;
  body block(mass = 1, position = x);
  friction dry(slip = der(x), bound = if der(x) > 0 then 1 else 2);
end M;
