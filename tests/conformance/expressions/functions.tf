// expect: ok
model M
  import Modelica.Math;
  Real x = time + 0.1;
  Real a = sqrt(x) + sin(x) + cos(x) + tan(x) + asin(0.1*x) + acos(0.1*x) + atan(x) + atan2(x, 2);
  Real b = sinh(x) + cosh(x) + tanh(x) + exp(x) + log(x) + log10(x);
  Real c = abs(x) + sign(x) + floor(x) + ceil(x) + integer(x) + mod(x, 2) + rem(x, 2) + div(x, 2) + min(x, 1) + max(x, 1);
  Real d = Modelica.Math.sin(x) + Math.cos(x) + TF.Math.exp(x);
  Real e = noEvent(if x > 0 then x else 0) + smooth(1, x) + (if initial() then 1 else 2) + homotopy(x, 1) + semiLinear(x, 1, 2);
  Real f = atan2(u1 = x, u2 = 1);
end M;
