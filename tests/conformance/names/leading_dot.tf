// expect: ok
model M
  model sin
    Real x = 1;
  end sin;
  package Modelica
    constant Real pi = 3;
  end Modelica;
  Real rough = Modelica.pi;
  Real exact = .Modelica.Constants.pi;
end M;
