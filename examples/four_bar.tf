// A four-bar linkage: three angles as coordinates, the loop closed by a constraint. The start gives the first angle; the others are found so
// that the loop is closed, nearest to their starts.
//
//   tfc run four_bar.tf --check-invariants
model FourBar "four-bar linkage that swings under its weight"
  parameter Real l[3](each unit = "m") = {0.3, 0.8, 0.5} "crank, coupler, rocker";
  parameter Real d(unit = "m") = 0.7 "distance of the pivots";
  parameter Real rho(unit = "kg/m") = 2 "mass of the bars per length";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  coordinate Real phi[3](start = {0.5, 0.6, 1.4}, fixed = {true, false, false}, der(fixed = {true, false, false}), each unit = "rad") "angles of the bars";
  Real A[2] = l[1]*{cos(phi[1]), sin(phi[1])} "end of the crank";
  Real B[2] = A + l[2]*{cos(phi[2]), sin(phi[2])} "end of the coupler";
  Real C[2] = {d, 0} + l[3]*{cos(phi[3]), sin(phi[3])} "end of the rocker";
  body bar[3](mass = rho*l, position = {A/2, (A + B)/2, ({d, 0} + C)/2}, angle = phi, inertia = {rho*l[i]^3/12 for i in 1:3});
  gravity weight(acceleration = {0, -g});
  constraint joint(residual = B - C);
  annotation(experiment(StopTime = 3, Tolerance = 1e-9));
end FourBar;
