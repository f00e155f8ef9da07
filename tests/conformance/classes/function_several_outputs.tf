// expect: ok
// model: M
function polar
  input Real x;
  input Real y;
  output Real radius = sqrt(x^2 + y^2);
  output Real angle = atan2(y, x);
end polar;
model M
  Real r, phi, psi;
equation
  (r, phi) = polar(1, time);
  (, psi) = polar(time, 1);
end M;
