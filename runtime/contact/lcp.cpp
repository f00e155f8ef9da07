#include "runtime/contact/lcp.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

constexpr double pivotTolerance = 1e-11;  // entries below are rounding errors of scaled data
constexpr double tieTolerance = 1e-12;

}  // namespace

void LinearComplementarity::resize(int size) {
  size_ = size;
  width_ = 2 * size + 2;
  matrix_.setZero(size, size);
  bias_.assign(size, 0.0);
  covering_.assign(size, 1.0);
  free_.assign(size, 0);
}

void LinearComplementarity::pivot(int leavingRow, int column) {
  ++pivots_;
  double *pivotRow = row(leavingRow);
  const double inverse = 1 / pivotRow[column];
  for (int c = 0; c < width_; ++c)
    pivotRow[c] *= inverse;
  pivotRow[column] = 1;
  for (int r = 0; r < size_; ++r) {
    double *target = row(r);
    const double factor = target[column];
    if (r == leavingRow || factor == 0)
      continue;
    for (int c = 0; c < width_; ++c)
      target[c] -= factor * pivotRow[c];
    target[column] = 0;
  }
  basic_[leavingRow] = column;
}

// Brings the free z into the basis in place of their w = 0, which never return.
LinearComplementarity::Status LinearComplementarity::eliminateFree(double tolerance) {
  while (true) {
    int bestRow = -1, bestColumn = -1;
    double best = pivotTolerance;
    for (int r = 0; r < size_; ++r) {
      if (!free_[r] || basic_[r] >= size_)
        continue;
      for (int c = 0; c < size_; ++c)
        if (free_[c] && std::abs(row(r)[size_ + c]) > best) {
          best = std::abs(row(r)[size_ + c]);
          bestRow = r;
          bestColumn = size_ + c;
        }
    }
    if (bestRow < 0)
      break;
    // The column may already be basic elsewhere only with entry 0 here, so it is not.
    pivot(bestRow, bestColumn);
    unrestricted_[bestRow] = 1;
  }
  for (int r = 0; r < size_; ++r) {
    if (!free_[r] || basic_[r] >= size_)
      continue;
    dropped_[r] = 1;
    if (std::abs(row(r)[2 * size_ + 1]) > tolerance)
      return Status::Contradictory;
  }
  return Status::Solved;
}

bool LinearComplementarity::lexicographicallySmaller(int a, int b, int column) {
  const double *rowA = row(a), *rowB = row(b);
  const double scaleA = 1 / rowA[column], scaleB = 1 / rowB[column];
  const int rhs = 2 * size_ + 1;
  for (int k = -1; k < size_; ++k) {
    if (k >= 0 && free_[k])
      continue;
    const int c = k < 0 ? rhs : k;
    const double ratioA = rowA[c] * scaleA, ratioB = rowB[c] * scaleB;
    if (std::abs(ratioA - ratioB) > tieTolerance * std::max({1.0, std::abs(ratioA), std::abs(ratioB)}))
      return ratioA < ratioB;
    if (k < 0 && (basic_[a] == 2 * size_ || basic_[b] == 2 * size_))
      return basic_[a] == 2 * size_;  // the covering variable leaves as soon as it can
  }
  return a < b;
}

int LinearComplementarity::leavingRow(int column) {
  int best = -1;
  for (int r = 0; r < size_; ++r) {
    if (unrestricted_[r] || dropped_[r] || row(r)[column] <= pivotTolerance)
      continue;
    if (best < 0 || lexicographicallySmaller(r, best, column))
      best = r;
  }
  return best;
}

LinearComplementarity::Status LinearComplementarity::solve(double tolerance) {
  const int rhs = 2 * size_ + 1, cover = 2 * size_;
  pivots_ = 0;
  tableau_.assign(static_cast<std::size_t>(size_) * static_cast<std::size_t>(width_), 0.0);
  basic_.resize(size_);
  unrestricted_.assign(size_, 0);
  dropped_.assign(size_, 0);
  z_.assign(size_, 0.0);
  for (int r = 0; r < size_; ++r) {
    double *target = row(r);
    target[r] = 1;
    for (int c = 0; c < size_; ++c)
      target[size_ + c] = -matrix_(r, c);
    target[cover] = free_[r] ? 0.0 : -covering_[r];
    target[rhs] = bias_[r];
    basic_[r] = r;
  }
  if (eliminateFree(tolerance) == Status::Contradictory)
    return Status::Contradictory;

  double zero = 0;  // elimination leaves rounding errors of the size of the data
  for (const double q : bias_)
    zero = std::max(zero, 1e-13 * std::abs(q));
  int first = -1;
  for (int r = 0; r < size_; ++r) {
    if (unrestricted_[r] || dropped_[r] || row(r)[rhs] >= -zero)
      continue;
    // Smallest bias/covering; of equal ones the last is lexicographically smallest.
    if (first < 0 || row(r)[rhs] * covering_[first] <= row(first)[rhs] * covering_[r])
      first = r;
  }
  if (first >= 0) {
    int leaving = basic_[first];
    pivot(first, cover);
    while (leaving != cover) {
      const int entering = leaving < size_ ? leaving + size_ : leaving - size_;
      const int r = leavingRow(entering);
      if (r < 0 || pivots_ > 50 * size_ + 100) {
        // A covering variable of rounding size is as good as gone.
        const auto covered = std::find(basic_.begin(), basic_.end(), cover);
        if (row(static_cast<int>(covered - basic_.begin()))[rhs] <= 100 * zero)
          break;
        return Status::Ray;
      }
      leaving = basic_[r];
      pivot(r, entering);
    }
  }
  for (int r = 0; r < size_; ++r)
    if (basic_[r] >= size_ && basic_[r] < cover)
      z_[basic_[r] - size_] = row(r)[rhs];
  return Status::Solved;
}

}  // namespace tf::runtime
