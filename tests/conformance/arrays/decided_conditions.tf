// expect: ok
model M "subscripts behind conditions on iterators, which are decided"
  parameter Integer n = 4;
  Real x[n](each start = 1, each fixed = true);
  Real before[n] = {if i == 1 then 0 else x[i - 1] for i in 1:n};
  Real around[n] = {if i == 1 then x[2] elseif i == n then x[n - 1] else x[i - 1] + x[i + 1] for i in 1:n};
  Real sums[n] = {if i == n then 0 else sum(x[i + 1:n]) for i in 1:n};
  Real corner[n, n] = {{if i > 1 then (if j > 1 then x[i - 1]*x[j - 1] else 0) else 1 for j in 1:n} for i in 1:n};
equation
  for i in 1:n loop
    der(x[i]) = if i < n then x[i + 1] - x[i] else -before[i];
  end for;
end M;
