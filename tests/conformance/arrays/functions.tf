// expect: ok
model M
  Real v[3] = {1, -2, time};
  Real a = sum(v) + product(v) + max(v) + min(v) + sum(v[i]^2 for i in 1:3) + max(v[1], v[2]);
  Real z[2, 3] = zeros(2, 3) + ones(2, 3) + fill(time, 2, 3);
  Real c[3] = cross(v, {1, 0, 0}), k[3, 3] = skew(v), d[3, 3] = diagonal(v), o[3, 3] = outerProduct(v, v);
  Real l[5] = linspace(0, time, 5), tr[3, 2] = transpose(z), sy[3, 3] = symmetric(k);
  parameter Integer n = size(v, 1), m = ndims(z), sizes[2] = size(z);
  Real sc = scalar({time}), ve[3] = vector([1; 2; 3]), ma[3, 1] = matrix(v);
  Real sv[3] = sin(v), ab[3] = abs(v);
end M;
