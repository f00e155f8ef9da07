// An optimization problem.
package Problems
  optimization Throw(objective = cost(finalTime), objectiveIntegrand = u[1]^2, startTime = 0, finalTime(free = true, min = 1))
    "least effort"
    extends Ball(mu = 0.6, q(start = {0, 1.5}, der(start = {1, 0})));
    parameter Real p(free = true);
    model Nested
      Real constraint;
    equation
      constraint = 1;
    end Nested;
  equation
    der(cost) = u[1]^2;
  constraint
    q(finalTime) = {3, 0};
    q[1](finalTime/2) <= 4;
    der(q)(finalTime) == {0, 0};
    x >= 0;
    0 = y;
    for i in 1:2 loop
      u[i] <= 1;
    end for;
    if p > 1 then
      v <= 2;
    end if;
    annotation(transcription(stages = 20));
  end Throw;
  constant optimization x;
  optimization y, z;
end Problems;
optimization Plain
constraint
end Plain;
