// expect: TF0313 at 11:10
// expect: TF0308 at 12:10
// expect: TF0312 at 13:27
// expect: TF0312 at 14:10
// expect: TF0323 at 15:23
// expect: TF0312 at 16:23
// expect: TF0312 at 17:19
model M
  coordinate Rotation R;
  coordinate Real phi, p[2];
  body a(orientation = phi, inertia = identity(3));
  body b(orientation = R);
  body c(orientation = R, inertia = 1);
  body d(position = p, mass = 1, orientation = R, inertia = identity(3));
  body e(angle = phi, orientation = R, inertia = 1);
  body f(angle = phi, inertia = identity(3));
  force g(at = R, value = 1);
end M;
