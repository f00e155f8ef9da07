model WhenEquation
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  when x > 1 then
    reinit(x, 0);
  end when;
end WhenEquation;
