// expect: ok
model M
  parameter Integer n = 4;
  parameter Real a[n] = {1, 2, 3, 4};
  Real last = a[end], middle[2] = a[2:end - 1], some[3] = a[{4, 1, 1}];
  Real m[2, 3] = [1, 2, 3; 4, 5, 6];
  Real row[3] = m[2, :], column[2] = m[:, end], part[1, 2] = m[{1}, 2:3];
end M;
