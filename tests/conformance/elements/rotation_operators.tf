// expect: TF0401 at 13:16
// expect: TF0401 at 14:15
// expect: TF0402 at 15:17
// expect: TF0424 at 16:12
// expect: TF0440 at 17:16
// expect: TF0440 at 18:25
// expect: TF0440 at 19:24
// expect: TF0401 at 20:15
model M
  coordinate Rotation R, Q;
  body top(orientation = R, inertia = identity(3));
  body tip(orientation = Q, inertia = identity(3));
  Rotation a = R + Q;
  Real b[2] = R*{1, 2};
  Rotation c = -R;
  Real d = R[1];
  Real e = sum(R);
  Rotation f = rotation({0, 0}, 1);
  Rotation g = inverse({1, 0, 0, 0});
  Boolean h = R == Q;
end M;
