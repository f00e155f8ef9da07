// expect: TF0201 at 6:13
model M
  parameter Real damping = 1;
  Real x(start = 1);
equation
  der(x) = -dampling*x;
end M;
