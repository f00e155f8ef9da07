#include "runtime/integrate/mass_matrix.h"

#include "runtime/contact/dense_kernels.h"
#include "runtime/integrate/dot.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tf::runtime {

namespace {

// Larger blocks with more than this part of all entries in their envelope are full.
constexpr int smallestFull = 12;
constexpr double full = 0.6;
// A pivot that has lost all but rounding errors of its diagonal entry is singular.
constexpr double singular = 1e-14;

// Calls f with the size as a compile-time constant.
template <class Function> auto withSize(int size, Function f) {
  switch (size) {
  case 1:
    return f(std::integral_constant<int, 1>{});
  case 2:
    return f(std::integral_constant<int, 2>{});
  case 3:
    return f(std::integral_constant<int, 3>{});
  case 4:
    return f(std::integral_constant<int, 4>{});
  case 5:
    return f(std::integral_constant<int, 5>{});
  default:
    return f(std::integral_constant<int, 6>{});
  }
}

// L (row-major, below the diagonal) and 1/Δ of the matrix with these rows. Returns the place of the pivot that failed, or −1.
template <int n> int factoriseFixed(const double *mass, int stride, const int *rows, double *factor, double *inverse) {
  double a[n][n];  // the lower triangle of what is left
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j)
      a[i][j] = mass[static_cast<std::ptrdiff_t>(rows[i]) * stride + rows[j]];
  double diagonal[n];
  for (int i = 0; i < n; ++i)
    diagonal[i] = a[i][i];
  for (int k = 0; k < n; ++k) {
    // Of infinite entries the comparison is false too.
    if (!(a[k][k] > singular * std::abs(diagonal[k])))
      return k;
    inverse[k] = 1 / a[k][k];
    for (int i = k + 1; i < n; ++i) {
      const double scaled = a[i][k] * inverse[k];
      for (int j = k + 1; j <= i; ++j)
        a[i][j] -= scaled * a[j][k];
      factor[i * n + k] = scaled;
    }
  }
  return -1;
}

template <int n> void forwardFixed(const double *factor, double *x) {
  for (int i = 1; i < n; ++i)
    for (int j = 0; j < i; ++j)
      x[i] -= factor[i * n + j] * x[j];
}

template <int n> void backwardFixed(const double *factor, double *x) {
  for (int i = n - 1; i > 0; --i)
    for (int j = 0; j < i; ++j)
      x[j] -= factor[i * n + j] * x[i];
}

}  // namespace

// Both halves of the structure without the diagonal.
struct MassMatrix::Pattern {
  std::vector<std::vector<int>> neighbours;

  Pattern(int size, const std::int32_t *rows, const std::int32_t *columns) : neighbours(static_cast<std::size_t>(size)) {
    for (int i = 0; i < size; ++i)
      for (int k = rows != nullptr ? rows[i] : 0; k < (rows != nullptr ? rows[i + 1] : i); ++k) {
        const int j = rows != nullptr ? columns[k] : k;
        neighbours[i].push_back(j);
        neighbours[j].push_back(i);
      }
  }

  // Rows that move one another, directly or not, ascending.
  [[nodiscard]] std::vector<std::vector<int>> components() const {
    std::vector<std::vector<int>> result;
    std::vector<char> seen(neighbours.size(), 0);
    for (std::size_t root = 0; root < neighbours.size(); ++root) {
      if (seen[root])
        continue;
      std::vector<int> rows{static_cast<int>(root)};
      seen[root] = 1;
      for (std::size_t k = 0; k < rows.size(); ++k)
        for (const int other : neighbours[rows[k]])
          if (!seen[other]) {
            seen[other] = 1;
            rows.push_back(other);
          }
      std::sort(rows.begin(), rows.end());
      result.push_back(std::move(rows));
    }
    return result;
  }

  // For rows in this order of elimination, the number of the first entry of each row of the envelope.
  [[nodiscard]] std::vector<int> envelope(const std::vector<int> &rows) const {
    std::vector<int> number(neighbours.size(), -1), first(rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k)
      number[rows[k]] = static_cast<int>(k);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      first[k] = static_cast<int>(k);
      for (const int other : neighbours[rows[k]])
        first[k] = std::min(first[k], number[other]);
    }
    return first;
  }

  // Multiplications of a factorisation, about.
  [[nodiscard]] double cost(const std::vector<int> &rows) const {
    const std::vector<int> first = envelope(rows);
    double sum = 0;
    for (std::size_t k = 0; k < rows.size(); ++k)
      sum += static_cast<double>(k - first[k]) * static_cast<double>(k - first[k]);
    return sum;
  }

  [[nodiscard]] std::vector<int> minimumDegree(const std::vector<int> &rows) const {
    std::vector<int> number(neighbours.size(), -1);
    for (std::size_t k = 0; k < rows.size(); ++k)
      number[rows[k]] = static_cast<int>(k);
    std::vector<Eigen::Triplet<double>> entries;
    for (const int row : rows) {
      entries.emplace_back(number[row], number[row], 1.0);
      for (const int other : neighbours[row])
        entries.emplace_back(number[row], number[other], 1.0);
    }
    const auto n = static_cast<int>(rows.size());
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> inverse;
    Eigen::AMDOrdering<int>()(matrix.selfadjointView<Eigen::Lower>(), inverse);
    std::vector<int> result(rows.size());
    for (int k = 0; k < n; ++k)
      result[k] = rows[inverse.indices()(k)];
    return result;
  }
};

MassMatrix::MassMatrix(int size, const std::int32_t *rows, const std::int32_t *columns)
    : size_(size), blockOf_(size), inverse_(size), unscaled_(size), work_(size) {
  const Pattern pattern(size, rows, columns);
  for (std::vector<int> &component : pattern.components())
    addBlock(pattern, std::move(component));
  for (int place = 0; place < size; ++place)
    inOrder_ = inOrder_ && rows_[place] == place;
}

void MassMatrix::addBlock(const Pattern &pattern, std::vector<int> rows) {
  const int begin = static_cast<int>(rows_.size()), n = static_cast<int>(rows.size());
  if (n > fixedSize) {
    std::vector<int> reverse(rows.rbegin(), rows.rend()), degree = pattern.minimumDegree(rows);
    const double own = pattern.cost(rows), backwards = pattern.cost(reverse), least = pattern.cost(degree);
    if (backwards < own && backwards <= least)
      rows = std::move(reverse);
    else if (least < own)
      rows = std::move(degree);
  }
  std::vector<int> first = pattern.envelope(rows);
  double entries = 0;
  for (int k = 0; k < n; ++k)
    entries += k - first[k];
  const bool isFull = n >= smallestFull && entries > full * 0.5 * n * (n - 1);
  if (isFull)
    std::fill(first.begin(), first.end(), 0);
  strides_.push_back(isFull ? paddedToLanes(n) : 0);
  unscaled_.resize(std::max(unscaled_.size(), std::size_t{4} * strides_.back()));
  for (int k = 0; k < n; ++k) {
    const auto width = isFull ? strides_.back() : n > fixedSize ? static_cast<std::ptrdiff_t>(k - first[k]) : n;
    first_.push_back(begin + first[k]);
    start_.push_back(static_cast<std::ptrdiff_t>(factor_.size()) - (n > fixedSize ? begin + first[k] : begin));
    factor_.resize(factor_.size() + static_cast<std::size_t>(width));
    blockOf_[rows[k]] = static_cast<int>(blocks_.size());
  }
  rows_.insert(rows_.end(), rows.begin(), rows.end());
  blocks_.push_back({begin, begin + n});
}

bool MassMatrix::factoriseEnvelope(const Block &block, const double *mass) {
  for (int i = block.begin; i < block.end; ++i) {
    double *row = rowOf(i);
    const double *source = mass + static_cast<std::ptrdiff_t>(rows_[i]) * size_;
    const int first = first_[i];
    // w = L Δ first, as w_ij = M_ij − Σ w_ik L_jk needs no scaling.
    double *w = unscaled_.data();
    for (int j = first; j < i; ++j) {
      const int begin = std::max(first, first_[j]);
      w[j] = source[rows_[j]] - dot(w + begin, rowOf(j) + begin, j - begin);
    }
    for (int j = first; j < i; ++j)
      row[j] = w[j] * inverse_[j];
    const double diagonal = source[rows_[i]];
    const double pivot = diagonal - dot(w + first, row + first, i - first);
    if (!(pivot > singular * std::abs(diagonal))) {
      failedRow_ = rows_[i];
      return false;
    }
    inverse_[i] = 1 / pivot;
  }
  return true;
}

bool MassMatrix::factoriseFull(std::size_t number, const double *mass) {
  const Block &block = blocks_[number];
  for (int i = block.begin; i < block.end; ++i) {
    double *row = rowOf(i);
    const double *source = mass + static_cast<std::ptrdiff_t>(rows_[i]) * size_;
    for (int j = block.begin; j <= i; ++j)
      row[j] = source[rows_[j]];
  }
  const int failed = factoriseDense(rowOf(block.begin) + block.begin, block.end - block.begin, strides_[number], singular,
                                    inverse_.data() + block.begin, unscaled_.data());
  if (failed >= 0)
    failedRow_ = rows_[block.begin + failed];
  return failed < 0;
}

bool MassMatrix::factorise(const double *mass) {
  for (std::size_t number = 0; number < blocks_.size(); ++number) {
    const Block &block = blocks_[number];
    const int n = block.end - block.begin;
    if (n > fixedSize) {
      if (!(strides_[number] > 0 ? factoriseFull(number, mass) : factoriseEnvelope(block, mass)))
        return false;
      continue;
    }
    const int failed = withSize(n, [&](auto size) {
      return factoriseFixed<size()>(mass, size_, rows_.data() + block.begin, rowOf(block.begin) + block.begin,
                                    inverse_.data() + block.begin);
    });
    if (failed >= 0) {
      failedRow_ = rows_[block.begin + failed];
      return false;
    }
  }
  isDiagonal_ = inOrder_ && hasDiagonalFactor();
  return true;
}

// Of matrices whose blocks are small; that of a body about its centre of mass is often diagonal though its entries could differ from zero.
bool MassMatrix::hasDiagonalFactor() const {
  for (const Block &block : blocks_) {
    if (block.end - block.begin > fixedSize)
      return false;
    for (int i = block.begin; i < block.end; ++i)
      for (int k = block.begin; k < i; ++k)
        if (rowOf(i)[k] != 0)
          return false;
  }
  return true;
}

// Places from `from`; those before are zero.
void MassMatrix::forwardEnvelope(const Block &block, int from, double *x) const {
  for (int i = from + 1; i < block.end; ++i) {
    const int begin = std::max(first_[i], from);
    x[i] -= dot(rowOf(i) + begin, x + begin, i - begin);
  }
}

void MassMatrix::forwardPanel(int number, int stride, double *panel) const {
  const Block &block = blocks_[number];
  tf::runtime::forwardPanel(factor_.data(), start_.data(), first_.data(), block.begin, block.end, stride, panel);
}

void MassMatrix::solve(const double *b, double *x) const {
  if (isDiagonal_) {
    for (int i = 0; i < size_; ++i)
      x[i] = b[i] * inverse_[i];
    return;
  }
  double *const y = inOrder_ ? x : work_.data();
  if (y != b)
    for (int place = 0; place < size_; ++place)
      y[place] = b[rows_[place]];
  for (const Block &block : blocks_) {
    const int n = block.end - block.begin;
    if (n > fixedSize)
      forwardEnvelope(block, block.begin, y);
    else
      withSize(n, [&](auto size) { forwardFixed<size()>(rowOf(block.begin) + block.begin, y + block.begin); });
    for (int place = block.begin; place < block.end; ++place)
      y[place] *= inverse_[place];
  }
  backward(y);
  for (int place = 0; place < size_ && !inOrder_; ++place)
    x[rows_[place]] = y[place];
}

int MassMatrix::forward(int number, const double *b, double *z, double *scaled) const {
  const Block &block = blocks_[number];
  for (int place = block.begin; place < block.end; ++place)
    z[place] = b[rows_[place]];
  int from = block.begin;
  while (from < block.end && z[from] == 0)
    ++from;
  const int n = block.end - block.begin;
  if (n > fixedSize)
    forwardEnvelope(block, from, z);
  else
    withSize(n, [&](auto size) { forwardFixed<size()>(rowOf(block.begin) + block.begin, z + block.begin); });
  for (int place = block.begin; place < block.end; ++place)
    scaled[place] = z[place] * inverse_[place];
  return from;
}

void MassMatrix::forward(const double *b, double *z, double *scaled) const {
  if (!isDiagonal_) {
    for (int block = 0; block < static_cast<int>(blocks_.size()); ++block)
      forward(block, b, z, scaled);
    return;
  }
  for (int i = 0; i < size_; ++i) {
    z[i] = b[i];
    scaled[i] = b[i] * inverse_[i];
  }
}

void MassMatrix::backward(double *y) const {
  for (const Block &block : blocks_) {
    const int n = block.end - block.begin;
    if (n > fixedSize)
      backwardRows(factor_.data(), start_.data(), first_.data(), block.begin, block.end, y);
    else
      withSize(n, [&](auto size) { backwardFixed<size()>(rowOf(block.begin) + block.begin, y + block.begin); });
  }
}

void MassMatrix::addBackward(double *y, double *x) const {
  if (!isDiagonal_)
    backward(y);
  for (int place = 0; place < size_; ++place)
    x[rows_[place]] += y[place];
}

}  // namespace tf::runtime
