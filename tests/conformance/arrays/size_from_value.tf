// expect: ok
model M
  parameter Real table[:, 2] = [0, 1; 1, 2; 2, 4];
  parameter Integer n = size(table, 1);
  Real x[n] = table[:, 1]*time;
end M;
