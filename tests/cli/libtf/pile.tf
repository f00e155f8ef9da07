// Eight discs on a rough floor with a belt, each pair of which may touch; an eccentric one, and a force that depends on the state. So many
// contacts that their derivatives are evaluated contact by contact.
model Pile "discs that touch one another"
  parameter Integer n = 8;
  parameter Real radius = 0.1, mu = 0.3, e = 0.2;
  input Real u;
  coordinate Real r[n, 2](start = {{0.25*i, 0.3 + 0.01*i} for i in 1:n});
  coordinate Real phi[n];
  body disc[n](mass = {0.1*i for i in 1:n}, position = {r[i, :] + 0.01*i*{cos(phi[i]), sin(phi[i])} for i in 1:n}, angle = phi, each inertia = 0.002);
  gravity weight(acceleration = {0, -9.81});
  force drive(value = u*r[1, 2] - 0.2*der(r[1, 1]), at = r[1, 1]);
  Real distance[n, n] = {{if i == j then 1 else sqrt((r[i, :] - r[j, :])*(r[i, :] - r[j, :])) for j in 1:n} for i in 1:n};
  contact floor[n](gap = {r[i, 2] - radius + 0.01*sin(3*r[i, 1] + time) for i in 1:n},
    slip = {der(r[i, 1]) + radius*der(phi[i]) - 0.1*time for i in 1:n}, friction = {mu*(1 + 0.1*r[i, 1]^2) for i in 1:n}, each restitution = e);
  contact pair[n - 1, n - 1](gap = {{if j >= i then distance[i, j + 1] - 2*radius else r[i, 1] + 10*j for j in 1:n - 1} for i in 1:n - 1},
    slip = {{if j >= i then ((r[i, 2] - r[j + 1, 2])*(der(r[i, 1]) - der(r[j + 1, 1])) - (r[i, 1] - r[j + 1, 1])*(der(r[i, 2]) - der(r[j + 1, 2])))/distance[i, j + 1] - radius*(der(phi[i]) + der(phi[j + 1])) else der(r[i, 2]) for j in 1:n - 1} for i in 1:n - 1},
    each friction = mu);
end Pile;
