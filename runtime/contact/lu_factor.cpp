#include "runtime/contact/lu_factor.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

bool LuFactor::factor(double singular) {
  const int n = lu_.rows();
  pivot_.resize(n);
  for (int k = 0; k < n; ++k) {
    double *columnK = lu_.column(k);
    int best = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(columnK[i]) > std::abs(columnK[best]))
        best = i;
    pivot_[k] = best;
    const double magnitude = std::abs(columnK[best]);
    if (!(magnitude > singular) || !std::isfinite(magnitude))
      return false;
    if (best != k)
      for (int j = 0; j < n; ++j)
        std::swap(lu_(k, j), lu_(best, j));
    const double inverse = 1 / columnK[k];
    for (int i = k + 1; i < n; ++i)
      columnK[i] *= inverse;
    for (int j = k + 1; j < n; ++j) {
      double *columnJ = lu_.column(j);
      const double factor = columnJ[k];
      if (factor != 0)
        for (int i = k + 1; i < n; ++i)
          columnJ[i] -= columnK[i] * factor;
    }
  }
  return true;
}

void LuFactor::solve(double *b) const {
  const int n = lu_.rows();
  for (int k = 0; k < n; ++k)
    std::swap(b[k], b[pivot_[k]]);
  for (int k = 0; k < n; ++k) {
    const double *column = lu_.column(k);
    for (int i = k + 1; i < n; ++i)
      b[i] -= column[i] * b[k];
  }
  for (int k = n - 1; k >= 0; --k) {
    const double *column = lu_.column(k);
    b[k] /= column[k];
    for (int i = 0; i < k; ++i)
      b[i] -= column[i] * b[k];
  }
}

}  // namespace tf::runtime
