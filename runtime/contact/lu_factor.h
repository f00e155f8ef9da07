// LU factorisation with partial pivoting for the small dense systems of contact modes, without allocation after the largest size.
#pragma once

#include "runtime/contact/dense.h"

#include <vector>

namespace tf::runtime {

class LuFactor {
public:
  // The square matrix to be factorised: fill it, then call `factor`, which overwrites it.
  DenseMatrix &matrix() { return lu_; }
  [[nodiscard]] const DenseMatrix &matrix() const { return lu_; }

  // False where a pivot's magnitude is not above `singular`, or not finite.
  bool factor(double singular);

  // The least singular value, by inverse iteration: at least that, and about it where the next one is several times larger. Partial
  // pivoting may spread it over several pivots none of which is as small.
  [[nodiscard]] double leastSingularValue();

  // b ← A⁻¹ b.
  void solve(double *b) const;
  // b ← A⁻ᵀ b.
  void solveTransposed(double *b) const;

  // 1/determinant as a product: of the pivots, the first one with the sign of the row exchanges; and the determinant of another matrix of
  // the same size times such a product, factor by factor.
  void inverseDeterminant(std::vector<double> &factors) const;
  [[nodiscard]] double determinantTimes(const std::vector<double> &factors) const;

private:
  bool factorTwo(double singular);
  [[nodiscard]] double signOfExchanges() const;

  DenseMatrix lu_;
  std::vector<int> pivot_;
  std::vector<double> direction_;
};

}  // namespace tf::runtime
