// expect: TF0202 at 3:3
model M
  Reel x;
equation
  x = 1;
end M;
