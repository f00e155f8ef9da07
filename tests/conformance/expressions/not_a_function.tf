// expect: TF0435 at 4:12
model M
  Real x[2] = {time, 1};
  Real y = x(1);
end M;
