#include "runtime/contact/semidefinite_factor.h"

#include "runtime/contact/dense_kernels.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

void SemidefiniteFactor::resize(int size) {
  matrix_.resize(size, size);
  factor_.resize(size, size);
  scale_.resize(size);
  order_.resize(size);
  work_.resize(size);
  rest_.resize(size);
  correction_.resize(size);
  rank_ = 0;
}

int SemidefiniteFactor::factor(double dependence) {
  const int n = matrix_.rows();
  if (n == 1)
    return rank_ = matrix_(0, 0) > 0 ? 1 : 0;
  for (int i = 0; i < n; ++i) {
    order_[i] = i;
    scale_[i] = matrix_(i, i) > 0 ? 1 / std::sqrt(matrix_(i, i)) : 0.0;
  }
  for (int j = 0; j < n; ++j)
    for (int i = j; i < n; ++i)
      factor_(i, j) = scale_[i] * matrix_(i, j) * scale_[j];
  rank_ = factoriseSemidefinite(factor_.data(), n, dependence, order_.data());
  return rank_;
}

void SemidefiniteFactor::solveOnce(const double *b, double *x) const {
  const int n = matrix_.rows();
  for (int k = 0; k < rank_; ++k)
    work_[k] = scale_[order_[k]] * b[order_[k]];
  for (int k = 0; k < rank_; ++k) {
    const double *column = factor_.column(k);
    work_[k] /= column[k];
    for (int i = k + 1; i < rank_; ++i)
      work_[i] -= column[i] * work_[k];
  }
  for (int k = rank_ - 1; k >= 0; --k)
    work_[k] = (work_[k] - denseDot(factor_.column(k) + k + 1, work_.data() + k + 1, rank_ - k - 1)) / factor_(k, k);
  std::fill_n(x, n, 0.0);
  for (int k = 0; k < rank_; ++k)
    x[order_[k]] = scale_[order_[k]] * work_[k];
}

// With one step of iterative refinement: rows that are nearly dependent make large solutions.
void SemidefiniteFactor::solve(const double *b, double *x) const {
  const int n = matrix_.rows();
  constexpr int smallestRefined = 3;
  // One contact, the most frequent by far.
  if (n == 1) {
    x[0] = rank_ == 1 ? b[0] / matrix_(0, 0) : 0;
    return;
  }
  std::copy_n(b, n, rest_.begin());
  solveOnce(rest_.data(), x);
  if (rank_ < smallestRefined)
    return;
  for (int j = 0; j < n; ++j) {
    const double *column = matrix_.column(j);
    double sum = column[j] * x[j];
    for (int i = j + 1; i < n; ++i) {
      rest_[i] -= column[i] * x[j];
      sum += column[i] * x[i];
    }
    rest_[j] -= sum;
  }
  solveOnce(rest_.data(), correction_.data());
  for (int i = 0; i < n; ++i)
    x[i] += correction_[i];
}

}  // namespace tf::runtime
