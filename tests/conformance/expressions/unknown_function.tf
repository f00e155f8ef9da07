// expect: TF0434 at 3:12
model M
  Real x = sine(time);
end M;
