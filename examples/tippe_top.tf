// The tippe top: a ball whose centre of mass lies below its centre. Spun fast, it slides on the floor, turns over and spins on its stem, with its
// centre of mass raised: friction turns energy of the spin into height. While it spins on a small patch of contact, friction resists slip like
// oil; dry friction of a point would soon end the slip. Jellett's integral, the momentum about the line from the centre of mass to the contact,
// does not change, whatever acts at the contact. Data: R. Leine, C. Glocker, A set-valued force law for spatial Coulomb-Contensou friction, 2003.
//
//   tfc run tippe_top.tf
model TippeTop "tippe top on a floor"
  parameter Real m(unit = "kg") = 0.006 "mass";
  parameter Real R(unit = "m") = 0.015 "radius";
  parameter Real a(unit = "m") = 0.003 "distance of the centre of mass below the centre";
  parameter Real J1(unit = "kg.m2") = 8e-7, J3(unit = "kg.m2") = 7e-7 "moments of inertia";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.3 "friction coefficient";
  parameter Real patch(unit = "m") = 5e-4 "radius of the patch of contact";
  parameter Real tilt(unit = "rad") = 0.1 "angle of the axis to the vertical at the start";
  parameter Real spin(unit = "rad/s") = 180 "angular velocity about the axis at the start";
  coordinate Real p[3](start = {0, 0, R - a*cos(tilt)}, each unit = "m") "centre of mass";
  coordinate Rotation Q(start = {cos(tilt/2), sin(tilt/2), 0, 0}, w(start = {0, 0, spin})) "orientation";
  Real axis[3] = Q*{0, 0, 1} "from the centre of mass to the centre";
  Real w[3] = Q*Q.w "angular velocity in space";
  Real arm[3] = a*axis - {0, 0, R} "from the centre of mass to the contact";
  Real slip[2] = {der(p[1]) + w[2]*arm[3] - w[3]*arm[2], der(p[2]) + w[3]*arm[1] - w[1]*arm[3]} "of the contact";
  Real drag[2] = -mu*m*g*slip/sqrt(slip*slip + (patch*w[3])^2) "friction";
  Real jellett = -(Q*{J1*Q.w[1], J1*Q.w[2], J3*Q.w[3]})*arm "Jellett's integral";
  body top(mass = m, position = p, orientation = Q, inertia = diagonal({J1, J1, J3}));
  gravity weight(acceleration = {0, 0, -g});
  contact floor(gap = p[3] + arm[3]);
  force pull(value = {drag[1], drag[2], 0}, at = p);
  force turn(value = cross(arm, {drag[1], drag[2], 0}), at = Q);
  annotation(experiment(StopTime = 3, Tolerance = 1e-9));
end TippeTop;
