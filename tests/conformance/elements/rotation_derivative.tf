// expect: TF0321 at 5:19
model M
  coordinate Rotation R;
  body top(orientation = R, inertia = identity(3));
  Real v[4] = der(R);
end M;
