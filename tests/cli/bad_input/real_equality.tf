model RealEquality
  Real x = if time == 1 then 1 else 0;
end RealEquality;
