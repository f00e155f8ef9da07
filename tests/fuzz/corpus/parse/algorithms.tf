function algorithms "all statements"
  input Real u[:];
  output Real y;
  output Integer n = size(u, 1);
protected
  Real t;
algorithm
  y := 0;
  (y, , t) := g(u, 2);
  () := h();
  a.b[1].c := {1, 2, 3};
  print("x");
  for i in 1:n loop
    if u[i] > 1 then
      break;
    elseif u[i] < -1 then
      return;
    else
      y := y + u[i];
    end if;
  end for;
  for i loop
    y := y*2;
  end for;
  while y > 1 and not y > 100 loop
    y := y/2;
  end while;
  when y > 1 then
    y := 0;
  elsewhen y < -1 then
    y := 1;
  end when "switch";
end algorithms;
pure function c
  input Real x;
  output Real y;
  external "C" y = cfun(x, size(x, 1)) annotation(Library = "m");
  annotation(derivative(order = 1) = dc, Inline = true);
end c;
impure function d
  external;
end d;
function e
  external "builtin" e(1);
end e;
function partialDerivative = der(f, x, y) "derivative";
function bound = algorithms(u = {1});
