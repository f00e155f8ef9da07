// Den Hartog's oscillator: a harmonic force drives a mass on a spring with dry friction. Near the limits of the drive the mass may stop twice or
// more in a period (J. P. Den Hartog, Forced vibrations with combined Coulomb and viscous friction, 1931).
//
//   tfc run den_hartog.tf --event-log events.csv
//   tfc run den_hartog.tf --set w=0.25        long stops
model DenHartog "forced oscillator with dry and viscous friction"
  parameter Real m(unit = "kg") = 1 "mass";
  parameter Real k(unit = "N/m") = 1 "stiffness";
  parameter Real d(unit = "N.s/m") = 0.1 "viscous damping";
  parameter Real R(unit = "N") = 0.6 "dry friction";
  parameter Real F(unit = "N") = 1 "amplitude of the drive";
  parameter Real w(unit = "rad/s") = 0.5 "its angular frequency";
  coordinate Real x(start = 0, unit = "m") "position";
  body mass(mass = m, position = x);
  potential spring(energy = k*x^2/2);
  force damper(value = -d*der(x), at = x);
  force drive(value = F*cos(w*time), at = x);
  friction dry(slip = der(x), bound = R);
  annotation(experiment(StopTime = 30, Tolerance = 1e-9));
end DenHartog;
