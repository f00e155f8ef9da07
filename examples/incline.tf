// A block is thrown up a rough slope. It comes to a stop; it stays there if mu > tan(alpha) and slides back otherwise.
//
//   tfc run incline.tf --set mu=0.3        slides back: event "slip reversal"
//   tfc run incline.tf --set mu=0.7        stays: event "stick"
model Incline "block on a rough slope"
  import Modelica.Constants.pi;
  parameter Real alpha(unit = "rad") = pi/6 "slope";
  parameter Real m(unit = "kg") = 2 "mass";
  parameter Real mu(min = 0) = 0.3 "friction coefficient";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  coordinate Real s(start = 0, der(start = 2), unit = "m") "along the slope, upwards";
  coordinate Real n(start = 0, unit = "m") "normal to the slope";
  Real r[2] = {s*cos(alpha) - n*sin(alpha), s*sin(alpha) + n*cos(alpha)} "position";
  body block(mass = m, position = r);
  potential weight(energy = m*g*r[2]);
  contact plane(gap = n, slip = der(s), friction = mu);
  annotation(experiment(StopTime = 2, Tolerance = 1e-9));
end Incline;
