// expect: TF0209 at 4:14
model M
  Real x = time;
  Real y = x.value;
end M;
