optimization Fast(objective = x(finalTime), startTime = 0, finalTime = 1)
  Real x(start = 1, fixed = true);
equation
  der(x) = -x;
end Fast;
