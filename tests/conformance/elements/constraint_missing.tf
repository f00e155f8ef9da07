// expect: TF0307 at 4:14
model M
  coordinate Real x;
  constraint wire;
end M;
