// expect: TF0324 at 6:9
// expect: TF0324 at 7:13
// expect: TF0324 at 8:12
// expect: TF0209 at 11:14
model M
  input Rotation a;
  parameter Rotation b;
  discrete Rotation c;
  coordinate Rotation R;
  body top(orientation = R, inertia = identity(3));
  Real x = R.x;
end M;
