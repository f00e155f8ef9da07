// expect: ok
model M
  import Modelica.Constants.*;
  Real x = pi*e + g_n + eps + small + TF.Constants.pi;
end M;
