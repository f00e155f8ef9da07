// expect: ok
// A recursion ends behind a condition that is decided when the model is compiled, in if-expressions as in if-statements.
function factorial
  input Integer n;
  output Integer f;
algorithm
  f := if n <= 1 then 1 else n*factorial(n - 1);
end factorial;
function isEven
  input Integer n;
  output Boolean even;
algorithm
  even := if n == 0 then true else isOdd(n - 1);
end isEven;
function isOdd
  input Integer n;
  output Boolean odd;
algorithm
  odd := if n == 0 then false else isEven(n - 1);
end isOdd;
function powers
  input Real x;
  input Integer n;
  output Real y[n];
protected
  Integer half = if n > 1 then integer(n/2) else 0;
algorithm
  y := if n == 0 then zeros(n) else cat(1, powers(x, n - 1), {x^n});
end powers;
function depth
  input Integer n;
  output Real d;
algorithm
  if n == 0 then
    d := 0;
  else
    d := 1 + depth(n - 1);
  end if;
end depth;
model M
  Real a[factorial(3)] = powers(time, 6);
  Real b = if isEven(4) and isOdd(3) then depth(5) else time;
  Real c = sum(powers(time, factorial(3)));
end M;
