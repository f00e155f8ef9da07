model SpinningTop
  coordinate Rotation R;
  body top(orientation = R, inertia = identity(3));
end SpinningTop;
