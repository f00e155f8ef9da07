within Modelica;
package Constants "mathematical constants and constants of nature (CODATA 2018)"
  // Mathematical constants
  final constant Real e = 2.71828182845904523536 "base of the natural logarithm";
  final constant Real pi = 3.14159265358979323846;
  final constant Real D2R = pi/180 "degree to radian";
  final constant Real R2D = 180/pi "radian to degree";
  final constant Real gamma = 0.57721566490153286061 "Euler's constant";
  // Machine dependent constants
  final constant Real eps = 2.220446049250313e-16 "biggest number such that 1.0 + eps = 1.0, up to rounding";
  final constant Real small = 1.0e-60 "smallest number such that small and -small are representable";
  final constant Real inf = 1.7976931348623157e308 "biggest Real number";
  final constant Integer Integer_inf = 2147483647 "biggest Integer number";
  // Constants of nature
  final constant Real c(unit = "m/s") = 299792458 "speed of light in vacuum";
  final constant Real g_n(unit = "m/s2") = 9.80665 "standard acceleration of gravity on earth";
  final constant Real G(unit = "m3/(kg.s2)") = 6.67430e-11 "Newtonian constant of gravitation";
  final constant Real q(unit = "C") = 1.602176634e-19 "elementary charge";
  final constant Real F(unit = "C/mol") = 96485.33212331 "Faraday constant";
  final constant Real h(unit = "J.s") = 6.62607015e-34 "Planck constant";
  final constant Real k(unit = "J/K") = 1.380649e-23 "Boltzmann constant";
  final constant Real R(unit = "J/(mol.K)") = k*N_A "molar gas constant";
  final constant Real sigma(unit = "W/(m2.K4)") = 5.670374419e-8 "Stefan-Boltzmann constant";
  final constant Real N_A(unit = "1/mol") = 6.02214076e23 "Avogadro constant";
  final constant Real mu_0(unit = "N/A2") = 4*pi*1.00000000055e-7 "magnetic constant";
  final constant Real epsilon_0(unit = "F/m") = 1/(mu_0*c*c) "electric constant";
  final constant Real T_zero(unit = "degC") = -273.15 "absolute zero temperature";
end Constants;
