// expect: ok
// model: M
function clamp
  input Real u;
  input Real lower = 0;
  input Real upper = 1;
  output Real y;
algorithm
  if u < lower then
    y := lower;
  elseif u > upper then
    y := upper;
  else
    y := u;
  end if;
end clamp;
model M
  Real x = clamp(time);
  Real y = clamp(time, upper = 2);
  Real z[2] = clamp({time, 2*time}, -1, 1);
end M;
