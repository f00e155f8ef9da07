// expect: ok
model M "parameters that the condition of a loop is on are structural, as those that sizes are on"
  function rowOf
    input Integer k;
    input Integer n;
    output Integer i;
  protected
    Integer rest;
  algorithm
    i := 1;
    rest := k;
    while rest > n - i loop
      rest := rest - (n - i);
      i := i + 1;
    end while;
  end rowOf;
  parameter Integer n = 4, other = 3;
  parameter Integer first[6] = {rowOf(k, n) for k in 1:6};
  Real x[n] = {time*i for i in 1:n};
  Real y[6] = {x[first[k]] for k in 1:6};
  Real z = x[rowOf(2, other)];
end M;
