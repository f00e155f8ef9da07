// A heavy top with its tip in a socket, started so that it precesses steadily: its axis keeps the angle to the vertical and goes round with the
// given rate. A little less spin makes it nod.
//
//   tfc run spinning_top.tf
//   tfc run spinning_top.tf --set 'R.w[3]=60' --stop-time 5
model SpinningTop "heavy symmetric top with a fixed point"
  parameter Real m(unit = "kg") = 0.5 "mass";
  parameter Real l(unit = "m") = 0.06 "distance of the centre of mass from the tip";
  parameter Real J1(unit = "kg.m2") = 4e-4, J3(unit = "kg.m2") = 6e-4 "moments of inertia about the centre of mass";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real tilt(unit = "rad") = 0.5 "angle of the axis to the vertical";
  parameter Real precession(unit = "rad/s") = 8 "rate of the precession";
  parameter Real spin(unit = "rad/s") = ((J1 + m*l^2)*precession^2*cos(tilt) + m*g*l)/(J3*precession) "component of the angular velocity along the axis";
  coordinate Rotation R(start = {cos(tilt/2), sin(tilt/2), 0, 0}, w(start = {0, precession*sin(tilt), spin})) "orientation";
  Real centre[3] = R*{0, 0, l} "centre of mass";
  body top(mass = m, position = centre, orientation = R, inertia = diagonal({J1, J1, J3}));
  gravity weight(acceleration = {0, 0, -g});
  annotation(experiment(StopTime = 5, Tolerance = 1e-9));
end SpinningTop;
