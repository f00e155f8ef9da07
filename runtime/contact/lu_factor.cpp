#include "runtime/contact/lu_factor.h"

#include "runtime/contact/dense_kernels.h"
#include "runtime/contact/irregular_numbers.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

// Sizes 1 and 2, one contact, are the most frequent by far: no loops.
bool LuFactor::factorTwo(double singular) {
  double *a = lu_.data();
  pivot_[0] = std::abs(a[1]) > std::abs(a[0]) ? 1 : 0;
  pivot_[1] = 1;
  if (pivot_[0] == 1) {
    std::swap(a[0], a[1]);
    std::swap(a[2], a[3]);
  }
  if (!(std::abs(a[0]) > singular) || !std::isfinite(a[0]))
    return false;
  a[1] *= 1 / a[0];
  a[3] -= a[1] * a[2];
  return std::abs(a[3]) > singular && std::isfinite(a[3]);
}

bool LuFactor::factor(double singular) {
  const int n = lu_.rows();
  if (n == 1) {
    const double magnitude = std::abs(lu_(0, 0));
    return magnitude > singular && std::isfinite(magnitude);
  }
  pivot_.resize(n);
  if (n == 2)
    return factorTwo(singular);
  if (n >= 16)
    return factoriseLu(lu_.data(), n, singular, pivot_.data());
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

double LuFactor::leastSingularValue() {
  constexpr int passes = 2;
  const int n = lu_.rows();
  direction_.resize(n);
  // A direction with a part along any other that could be the one.
  for (int k = 0; k < n; ++k)
    direction_[k] = irregularNumber(k);
  const auto normalise = [&] {
    const double length = std::sqrt(denseDot(direction_.data(), direction_.data(), n));
    for (double &value : direction_)
      value /= length;
    return length;
  };
  normalise();
  double value = 0;
  for (int pass = 0; pass < passes; ++pass) {
    solve(direction_.data());
    normalise();
    solveTransposed(direction_.data());
    value = 1 / normalise();
  }
  return std::isfinite(value) ? value : 0;
}

double LuFactor::signOfExchanges() const {
  double sign = 1;
  for (int k = 0; lu_.rows() > 1 && k < lu_.rows(); ++k)
    if (pivot_[k] != k)
      sign = -sign;
  return sign;
}

void LuFactor::inverseDeterminant(std::vector<double> &factors) const {
  factors.resize(lu_.rows());
  for (int k = 0; k < lu_.rows(); ++k)
    factors[k] = (k == 0 ? signOfExchanges() : 1) / lu_(k, k);
}

double LuFactor::determinantTimes(const std::vector<double> &factors) const {
  double ratio = signOfExchanges();
  for (int k = 0; k < lu_.rows(); ++k)
    ratio *= lu_(k, k) * factors[k];
  return ratio;
}

void LuFactor::solve(double *b) const {
  const int n = lu_.rows();
  if (n == 1) {
    b[0] /= lu_(0, 0);
    return;
  }
  if (n == 2) {
    const double *a = lu_.data();
    const double first = b[pivot_[0]];
    b[1] = (b[1 - pivot_[0]] - a[1] * first) / a[3];
    b[0] = (first - a[2] * b[1]) / a[0];
    return;
  }
  solveLu(lu_.data(), n, pivot_.data(), b);
}

void LuFactor::solveTransposed(double *b) const {
  const int n = lu_.rows();
  for (int k = 0; k < n; ++k)
    b[k] = (b[k] - denseDot(lu_.column(k), b, k)) / lu_(k, k);
  for (int k = n - 2; k >= 0; --k)
    b[k] -= denseDot(lu_.column(k) + k + 1, b + k + 1, n - k - 1);
  for (int k = n - 2; k >= 0; --k)
    std::swap(b[k], b[pivot_[k]]);
}

}  // namespace tf::runtime
