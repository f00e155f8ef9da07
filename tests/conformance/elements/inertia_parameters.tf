// expect: ok
model M "tensors of inertia out of parameters, some of which are zero"
  parameter Real Ixx = 0.02, Iyy = 0.03, Izz = 0.04, Ixy = 0;
  parameter Real I[3, 3] = [0.2, 0.01, 0; 0.01, 0.16, 0; 0, 0, 0.17];
  parameter Real J[3, 3] = 1*identity(3);
  coordinate Rotation R[3](each w(start = {0.01, 5, 0}));
  body a(orientation = R[1], inertia = [Ixx, Ixy, 0; Ixy, Iyy, 0; 0, 0, Izz]);
  body b(orientation = R[2], inertia = I);
  body c(orientation = R[3], inertia = J);
end M;
