// expect: TF0408 at 3:25
model M
  parameter Integer n = 1.5;
end M;
