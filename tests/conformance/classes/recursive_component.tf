// expect: TF0217 at 3:5
model M
  M inside;
end M;
