// Symmetric positive semidefinite systems: Cholesky's method with diagonal pivoting (Higham, Accuracy and Stability of Numerical
// Algorithms, 2002, section 10.3), which ends where the rows that are left depend on those before.
#pragma once

#include "runtime/contact/dense.h"

#include <vector>

namespace tf::runtime {

class SemidefiniteFactor {
public:
  // Entries are undefined afterwards; those on and below the diagonal are wanted.
  void resize(int size);
  double &entry(int row, int column) { return matrix_(row, column); }

  // A row depends on others where less than `dependence` of its diagonal entry is left. Returns the rank.
  int factor(double dependence);
  [[nodiscard]] int rank() const { return rank_; }
  // x with A x = b where the system is consistent, zero in the rows that depend on others; x and b may be the same.
  void solve(const double *b, double *x) const;

private:
  void solveOnce(const double *b, double *x) const;

  DenseMatrix matrix_, factor_;
  std::vector<double> scale_;  // 1/√A_ii
  std::vector<int> order_;     // of the pivots
  mutable std::vector<double> work_, rest_, correction_;
  int rank_ = 0;
};

}  // namespace tf::runtime
