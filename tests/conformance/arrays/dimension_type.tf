// expect: TF0417 at 3:10
model M
  Real x[2.5];
end M;
