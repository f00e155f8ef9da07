// expect: ok
model M "values of records behind decided conditions"
  record Point
    Real x;
    Real y;
  end Point;
  parameter Integer n = 3;
  Point corner[n] = {Point(i, 2*i) for i in 1:n};
  Point before[n] = {if i == 1 then Point(0, 0) else corner[i - 1] for i in 1:n};
  Point grid[2, n] = {Point(i, j) for i in 1:n, j in 1:2};
  Point row[n] = {grid[2, j] for j in 1:n};
  Point last = if n > 0 then corner[n] else corner[0];
end M;
