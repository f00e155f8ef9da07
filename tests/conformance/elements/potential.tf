// expect: ok
model M
  parameter Real k = 10;
  coordinate Real x;
  body b(mass = 1, position = x);
  potential spring(energy = 0.5*k*x^2);
  potential stop(energy = if x > 1 then 50*(x - 1)^2 else 0);
  Real e = spring.energy;
end M;
