// The symmetric positive definite mass matrix: Cholesky factor, solutions, and the explicit inverse of a constant one.
#pragma once

#include <vector>

namespace tf::runtime {

class MassMatrix {
public:
  explicit MassMatrix(int size) : size_(size), factor_(static_cast<std::size_t>(size) * size), inverseDiagonal_(size) {}

  // Factorises M [n × n, row-major, symmetric]. False if it is not positive definite (or not finite).
  bool factorise(const double *mass);
  // x = M⁻¹ b; x and b may be the same.
  void solve(const double *b, double *x) const;
  // Row (from 0) of the last pivot that failed.
  [[nodiscard]] int failedRow() const { return failedRow_; }

private:
  int size_;
  std::vector<double> factor_;           // lower triangle of L, row-major
  std::vector<double> inverseDiagonal_;  // 1 / L_ii; of a diagonal matrix 1 / M_ii
  bool diagonal_ = false;
  int failedRow_ = -1;
};

}  // namespace tf::runtime
