// expect: ok
model M
  Real v[3] = {1, 2, time}, A[3, 3] = identity(3)*time;
  Real s = v*v, w[3] = A*v, u[3] = v*A, B[3, 3] = A*A;
  Real p[3] = v .* v, q[3] = v ./ {1, 2, 4}, r[3] = v .^ 2, t[3] = 1 .+ v, x[3] = v/2 - 3*v;
  Real C[3, 3] = A^3;
end M;
