// expect: TF0419 at 3:24
model M
  parameter Real table[:];
end M;
