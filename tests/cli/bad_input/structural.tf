model Structural
  parameter Integer n = 2 annotation(Evaluate = true);
  final parameter Real k = 2;
  parameter Real c(min = 0, max = 1) = 0.5;
  parameter Integer count = 3;
  input Real u;
  Real x[n](each start = 1, each fixed = true);
equation
  for i in 1:n loop
    der(x[i]) = -k*c*x[i] + u + count;
  end for;
end Structural;
