// expect: TF0301 at 3:14
model M
  coordinate Integer n;
end M;
