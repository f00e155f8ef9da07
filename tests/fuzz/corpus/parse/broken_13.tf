package P
  model M
    Real x;
  equation
    when x > 1 then
      y = 2;
    x = 2;
end P;
