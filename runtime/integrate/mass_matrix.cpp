#include "runtime/integrate/mass_matrix.h"

#include <cmath>

namespace tf::runtime {

bool MassMatrix::factorise(const double *mass) {
  const int n = size_;
  diagonal_ = true;
  for (int i = 0; i < n && diagonal_; ++i)
    for (int j = 0; j < i; ++j)
      diagonal_ = diagonal_ && mass[i * n + j] == 0;
  if (diagonal_) {
    for (int i = 0; i < n; ++i) {
      if (!(mass[i * n + i] > 0) || !std::isfinite(mass[i * n + i])) {
        failedRow_ = i;
        return false;
      }
      inverseDiagonal_[i] = 1 / mass[i * n + i];
    }
    return true;
  }
  for (int i = 0; i < n; ++i) {
    double *row = factor_.data() + i * n;
    for (int j = 0; j < i; ++j) {
      const double *other = factor_.data() + j * n;
      double sum = mass[i * n + j];
      for (int k = 0; k < j; ++k)
        sum -= row[k] * other[k];
      row[j] = sum * inverseDiagonal_[j];
    }
    double pivot = mass[i * n + i];
    for (int k = 0; k < i; ++k)
      pivot -= row[k] * row[k];
    // A pivot that has lost all but rounding errors of its diagonal entry is singular.
    if (!(pivot > 1e-14 * std::abs(mass[i * n + i])) || !std::isfinite(pivot)) {
      failedRow_ = i;
      return false;
    }
    inverseDiagonal_[i] = 1 / std::sqrt(pivot);
  }
  return true;
}

void MassMatrix::solve(const double *b, double *x) const {
  const int n = size_;
  if (diagonal_) {
    for (int i = 0; i < n; ++i)
      x[i] = b[i] * inverseDiagonal_[i];
    return;
  }
  for (int i = 0; i < n; ++i) {
    const double *row = factor_.data() + i * n;
    double sum = b[i];
    for (int k = 0; k < i; ++k)
      sum -= row[k] * x[k];
    x[i] = sum * inverseDiagonal_[i];
  }
  for (int i = n - 1; i >= 0; --i) {
    double sum = x[i];
    for (int k = i + 1; k < n; ++k)
      sum -= factor_[k * n + i] * x[k];
    x[i] = sum * inverseDiagonal_[i];
  }
}

}  // namespace tf::runtime
