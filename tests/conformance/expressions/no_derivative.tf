// expect: TF0321 at 4:16
model M
  input Real u;
  Real x = der(u);
end M;
