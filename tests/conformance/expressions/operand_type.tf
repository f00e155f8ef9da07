// expect: TF0402 at 3:19
model M
  Boolean b = not 3;
end M;
