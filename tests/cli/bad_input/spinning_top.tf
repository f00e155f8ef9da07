model SpinningTop
  coordinate Rotation R;
  body top(orientation = R, inertia = 0.2);
  Real spin[4] = der(R);
end SpinningTop;
