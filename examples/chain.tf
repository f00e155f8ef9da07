// A chain of n rods falls on a rough floor and comes to rest flat on it, with n + 1 sticking nodes. Absolute angles as coordinates; the equations
// of motion are derived from the positions of the nodes, which are plain variables.
//
//   tfc run chain.tf --event-log events.csv
//   tfc run chain.tf --set n=20 --stop-time 2
model Chain "free chain of uniform rods above a rough floor"
  parameter Integer n(min = 1) = 3 "number of rods";
  parameter Real l(unit = "m") = 1/n "length of a rod";
  parameter Real m(unit = "kg") = 1/n "mass of a rod";
  parameter Real d = 0.002 "joint damping";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  parameter Real mu(min = 0) = 0.5 "friction coefficient";
  parameter Real drop(unit = "m") = max({-l*sum({sin(0.9 - 0.25*(i - 1)) for i in 1:k}) for k in 1:n}) "of the lowest node below the first";
  coordinate Real r[2](start = {0, max(0.3, drop + 0.02)}, der(start = {0.5, 0}), each unit = "m") "first node";
  coordinate Real phi[n](start = {0.9 - 0.25*(i - 1) for i in 1:n}, each unit = "rad") "angles of the rods";
  Real node[n + 1, 2] "positions of the nodes";
  body rod[n](each mass = m, position = (node[1:n, :] + node[2:n + 1, :])/2, angle = phi, each inertia = m*l^2/12);
  gravity weight(acceleration = {0, -g});
  force damper[n - 1](value = -d*(der(phi[2:n]) - der(phi[1:n - 1])), at = phi[2:n] - phi[1:n - 1]);
  contact floor[n + 1](gap = node[:, 2], slip = der(node[:, 1]), each friction = mu);
equation
  node[1, :] = r;
  for i in 1:n loop
    node[i + 1, :] = node[i, :] + l*{cos(phi[i]), sin(phi[i])};
  end for;
  annotation(experiment(StopTime = 1, Tolerance = 1e-9));
end Chain;
