// expect: ok
model M "inputs of components are ordinary variables"
  block Gain
    input Real u;
    parameter Real k = 2;
    output Real y = k*u;
  end Gain;
  coordinate Real x;
  body b(mass = 1, position = x);
  Gain first(u = x), second;
  Real rate = der(first.y);
equation
  second.u = first.y;
end M;
