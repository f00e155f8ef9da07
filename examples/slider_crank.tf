// A slider-crank mechanism whose slider has clearance in its channel: two corners hit a wall together, slide along it and leave it together
// (the benchmark of P. Flores, R. Leine and C. Glocker, 2010, here without rebound).
//
//   tfc run slider_crank.tf --event-log events.csv
model SliderCrank "crank, connecting rod and a slider with clearance"
  parameter Real l[2](each unit = "m") = {0.153, 0.306} "lengths of crank and rod";
  parameter Real m[3](each unit = "kg") = {0.038, 0.038, 0.076} "masses of crank, rod and slider";
  parameter Real J[3](each unit = "kg.m2") = {7.4e-5, 5.9e-4, 2.7e-6} "moments of inertia";
  parameter Real a(unit = "m") = 0.05 "half length of the slider";
  parameter Real b(unit = "m") = 0.025 "half height of the slider";
  parameter Real d(unit = "m") = 0.026 "half height of the channel";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.01 "friction coefficient";
  coordinate Real phi[3](start = {0, 0, 0}, der(start = {150, -75, 0}), each unit = "rad") "angles of crank, rod and slider";
  Real e[3, 2] = {{cos(phi[i]), sin(phi[i])} for i in 1:3} "directions of the bodies";
  Real joint[2, 2] = {l[1]*e[1, :], l[1]*e[1, :] + l[2]*e[2, :]} "ends of crank and rod";
  Real up[2] = {-e[3, 2], e[3, 1]} "across the slider";
  Real corner[4, 2] = {joint[2, :] - a*e[3, :] + b*up, joint[2, :] + a*e[3, :] + b*up, joint[2, :] - a*e[3, :] - b*up, joint[2, :] + a*e[3, :] - b*up};
  body link[3](mass = m, position = {joint[1, :]/2, (joint[1, :] + joint[2, :])/2, joint[2, :]}, angle = phi, inertia = J);
  gravity weight(acceleration = {0, -g});
  contact upper[2](gap = {d - corner[1, 2], d - corner[2, 2]}, slip = der(corner[1:2, 1]), each friction = mu);
  contact lower[2](gap = {d + corner[3, 2], d + corner[4, 2]}, slip = der(corner[3:4, 1]), each friction = mu);
  annotation(experiment(StopTime = 0.1, Tolerance = 1e-9));
end SliderCrank;
