model ArgumentCount
  Real x = sin(time, 2);
end ArgumentCount;
