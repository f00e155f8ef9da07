#include "runtime/integrate/mass_matrix.h"

#include "runtime/integrate/dot.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

// Rows in their own order are read up to the diagonal, rows in reverse from the end down to it.
void MassMatrix::findEnvelope(const double *mass) {
  const int n = size_;
  double forward = 0, backward = 0;  // multiplications, about
  for (int i = 0; i < n; ++i) {
    const double *row = mass + static_cast<std::ptrdiff_t>(i) * n;
    int first = 0, last = n - 1;
    while (first < i && row[first] == 0)
      ++first;
    while (last > i && row[last] == 0)
      --last;
    first_[i] = first;
    reversedFirst_[n - 1 - i] = n - 1 - last;
    forward += static_cast<double>(i - first) * (i - first);
    backward += static_cast<double>(last - i) * (last - i);
  }
  diagonal_ = forward == 0;
  isReversed_ = backward < forward;
  if (isReversed_)
    std::swap(first_, reversedFirst_);
}

bool MassMatrix::invertDiagonal(const double *mass) {
  for (int i = 0; i < size_; ++i) {
    const double pivot = mass[static_cast<std::ptrdiff_t>(i) * size_ + i];
    if (!(pivot > 0) || !std::isfinite(pivot)) {
      failedRow_ = i;
      return false;
    }
    inverseDiagonal_[i] = 1 / pivot;
  }
  return true;
}

bool MassMatrix::factorise(const double *mass) {
  const int n = size_;
  findEnvelope(mass);
  if (diagonal_)
    return invertDiagonal(mass);
  for (int i = 0; i < n; ++i) {
    double *row = factor_.data() + static_cast<std::ptrdiff_t>(i) * n;
    const double *source = mass + static_cast<std::ptrdiff_t>(rowOf(i)) * n;
    for (int j = first_[i]; j < i; ++j) {
      const double *other = factor_.data() + static_cast<std::ptrdiff_t>(j) * n;
      const int begin = std::max(first_[i], first_[j]);
      row[j] = (source[rowOf(j)] - dot(row + begin, other + begin, j - begin)) * inverseDiagonal_[j];
    }
    const double diagonal = source[rowOf(i)];
    const double pivot = diagonal - dot(row + first_[i], row + first_[i], i - first_[i]);
    // A pivot that has lost all but rounding errors of its diagonal entry is singular.
    if (!(pivot > 1e-14 * std::abs(diagonal)) || !std::isfinite(pivot)) {
      failedRow_ = rowOf(i);
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
  if (x != b)
    std::copy_n(b, n, x);
  if (isReversed_)
    std::reverse(x, x + n);
  for (int i = 0; i < n; ++i) {
    const int begin = first_[i];
    x[i] = (x[i] - dot(factor_.data() + static_cast<std::ptrdiff_t>(i) * n + begin, x + begin, i - begin)) * inverseDiagonal_[i];
  }
  for (int i = n - 1; i >= 0; --i) {
    const double *row = factor_.data() + static_cast<std::ptrdiff_t>(i) * n;
    x[i] *= inverseDiagonal_[i];
    for (int k = first_[i]; k < i; ++k)
      x[k] -= row[k] * x[i];
  }
  if (isReversed_)
    std::reverse(x, x + n);
}

}  // namespace tf::runtime
