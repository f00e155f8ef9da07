model Equations
initial equation
  x = 0;
  der(x) = 1 "slow" annotation(x = 1);
equation
  (a, , b) = f(x, y);
  0 = x + y;
  block.x = 2;
  if initial() then
    x = 1;
  elseif noEvent(x < 2) then
    x = 2;
  else
    x = 3;
  end if;
  for i in 1:n, j in {1, 2}, k loop
    a[i, j] = b[j, i]*k;
  end for;
  when {x > 1, sample(0, 1)} then
    reinit(v, -e*pre(v));
  elsewhen edge(b) then
    terminate("done");
  end when;
  connect(a.p[1], b.n) annotation(Line(points = {{0, 0}, {1, 1}}));
  assert(x > 0, "x is negative", level = AssertionLevel.warning);
  Modelica.Utilities.Streams.print("text");
  for i in 1:3 loop
  end for;
public
  Real late;
algorithm
  x := 1;
initial algorithm
  y := 2;
end Equations;
