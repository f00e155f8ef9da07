// expect: ok
model M
  Real x, y(start = 1);
initial equation
  der(x) = 0;
equation
  der(x) = y - x;
  der(y) = -y;
end M;
