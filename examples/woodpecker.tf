// The woodpecker toy: a sleeve on a pole, and a woodpecker on a spring on the sleeve. Tilted, the sleeve jams on the pole by friction; the
// woodpecker swings, frees the sleeve for a short fall, hits the pole with its beak and swings back: a limit cycle of slip, jam and impact.
// Model and data: C. Glocker, Dynamik von Starrkoerpersystemen mit Reibung und Stoessen, 1995; R. Leine, C. Glocker and D. van Campen,
// Nonlinear dynamics of the woodpecker toy, 2001; small angles and Newton's impact law, as there.
//
//   tfc run woodpecker.tf --event-log events.csv
model Woodpecker "woodpecker toy"
  parameter Real mS(unit = "kg") = 0.0045, mM(unit = "kg") = 0.0003 "masses of woodpecker and sleeve";
  parameter Real JS(unit = "kg.m2") = 7e-7, JM(unit = "kg.m2") = 5e-9 "moments of inertia";
  parameter Real lM(unit = "m") = 0.01, lG(unit = "m") = 0.015 "distances: sleeve to spring, spring to woodpecker";
  parameter Real lS(unit = "m") = 0.0201, hS(unit = "m") = 0.02 "beak: from the woodpecker, across and along the pole";
  parameter Real r0(unit = "m") = 0.0025, rM(unit = "m") = 0.0031, hM(unit = "m") = 0.0058 "radii of pole and sleeve, half length of the sleeve";
  parameter Real c(unit = "N.m/rad") = 0.0056 "stiffness of the spring";
  parameter Real mu(min = 0) = 0.3 "friction coefficient";
  parameter Real e(min = 0, max = 1) = 0.5 "coefficient of restitution of the beak";
  parameter Real g(unit = "m/s2") = 9.81 "gravity";
  coordinate Real y(start = 0, der(start = -0.3411), unit = "m") "height of the sleeve";
  coordinate Real phiM(start = -(rM - r0)/hM, unit = "rad") "angle of the sleeve";
  coordinate Real phiS(start = -0.2788, der(start = -7.4583), unit = "rad") "angle of the woodpecker";
  body sleeve(mass = mM, position = {0, y}, angle = phiM, inertia = JM);
  body woodpecker(mass = mS, position = {0, y + lM*phiM + lG*phiS}, angle = phiS, inertia = JS);
  gravity weight(acceleration = {0, -g});
  potential spring(energy = c*(phiS - phiM)^2/2);
  contact beak(gap = lM + lG - lS - r0 - hS*phiS, slip = der(y) + lM*der(phiM) + (lG - lS)*der(phiS), friction = mu, restitution = e, law = ImpactLaw.Newton);
  contact lower(gap = rM - r0 + hM*phiM, slip = der(y) + rM*der(phiM), friction = mu);
  contact upper(gap = rM - r0 - hM*phiM, slip = der(y) + rM*der(phiM), friction = mu);
  annotation(experiment(StopTime = 0.6, Tolerance = 1e-9));
end Woodpecker;
