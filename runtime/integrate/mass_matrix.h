// The symmetric positive definite mass matrix: Cholesky factor within its envelope, and solutions.
//
// Zeros before the first entry of a row stay zero in the factor. The unknowns are eliminated in their own order or from the last to the
// first, whichever has the smaller envelope: bodies that do not move one another cost what they cost alone, and of branches from a common
// base, numbered outwards, elimination from the tips (LᵀDL, Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.5) fills nothing.
#pragma once

#include <vector>

namespace tf::runtime {

class MassMatrix {
public:
  explicit MassMatrix(int size)
      : size_(size), factor_(static_cast<std::size_t>(size) * size), inverseDiagonal_(size), first_(size), reversedFirst_(size) {}

  // Factorises M [n × n, row-major, symmetric]. False if it is not positive definite (or not finite).
  bool factorise(const double *mass);
  // x = M⁻¹ b; x and b may be the same.
  void solve(const double *b, double *x) const;
  // Row (from 0) of the last pivot that failed.
  [[nodiscard]] int failedRow() const { return failedRow_; }

private:
  void findEnvelope(const double *mass);
  bool invertDiagonal(const double *mass);
  [[nodiscard]] int rowOf(int place) const { return isReversed_ ? size_ - 1 - place : place; }

  int size_;
  std::vector<double> factor_;              // lower triangle of L in the order of elimination, row-major
  std::vector<double> inverseDiagonal_;     // 1 / L_ii; of a diagonal matrix 1 / M_ii
  std::vector<int> first_, reversedFirst_;  // column of the first entry of each row of L
  bool diagonal_ = false, isReversed_ = false;
  int failedRow_ = -1;
};

}  // namespace tf::runtime
