// expect: TF0234 at 9:14
// model: Stop
model Cart
  input Real u;
  Real x(start = 1);
equation
  der(x) = u;
end Cart;
optimization Stop(objectiveIntegrand = u^2, startTime = 0, finalTime = 1)
  extends Cart;
constraint
  x(finalTime) = 0;
end Stop;
