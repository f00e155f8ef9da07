#include "runtime/integrate/semiseparable_system.h"

#include "runtime/contact/dense_kernels.h"
#include "runtime/integrate/all_finite.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <type_traits>

namespace tf::runtime {

namespace {

// What is left of a row by the vectors is no vector of its own up to this, relative to the row: refinement makes up for it.
constexpr double madeUp = 1e-12;
// A vector whose entries in all columns that are left are that small, relative to those that it had, is none there.
constexpr double vanishing = 1e-15;

// The first entry that is not much smaller than the largest: early columns remain longest.
int pivotOf(const double *x, int end, double largest) {
  int column = 0;
  while (column < end - 1 && !(std::abs(x[column]) >= 0.05 * largest))
    ++column;
  return column;
}

template <int R> double product(const double *a, const double *b) {
  double sum = 0;
  for (int k = 0; k < R; ++k)
    sum += a[k] * b[k];
  return sum;
}

// −W g and −Wᵀ p into m and l. Returns the pivot, `diagonal` − p·W g, and the size of what it is the difference of.
template <int R>
[[gnu::always_inline]] inline double findPivot(const double (&W)[R][R], const double *p, const double *g, double diagonal, double (&m)[R],
                                               double (&l)[R], double &size) {
  double pivot = size = diagonal;
  for (int i = 0; i < R; ++i) {
    double Wg = 0, Wp = 0;
    for (int j = 0; j < R; ++j) {
      Wg += W[i][j] * g[j];
      Wp += W[j][i] * p[j];
    }
    pivot -= p[i] * Wg;
    size += std::abs(p[i] * Wg);
    m[i] = -Wg;
    l[i] = -Wp;
  }
  return pivot;
}

// W += m lᵀ/pivot. The product of the factors does not wait for the quotient.
template <int R>
[[gnu::always_inline]] inline void addFactors(const double (&m)[R], const double (&l)[R], double inverse, double (&W)[R][R]) {
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < R; ++j)
      W[i][j] += m[i] * l[j] * inverse;
}

// Of the number of vectors as a constant.
template <class Function> auto withVectors(int count, const Function &function) {
  static_assert(SemiseparableSystem::mostVectors == 6);
  switch (count) {
  case 1:
    return function(std::integral_constant<int, 1>());
  case 2:
    return function(std::integral_constant<int, 2>());
  case 3:
    return function(std::integral_constant<int, 3>());
  case 4:
    return function(std::integral_constant<int, 4>());
  case 5:
    return function(std::integral_constant<int, 5>());
  default:
    return function(std::integral_constant<int, 6>());
  }
}

}  // namespace

void SemiseparableSystem::Determinant::multiply(double factor) {
  mantissa *= factor;
  constexpr double large = 1e100, small = 1e-100;
  if (const double size = std::abs(mantissa); size > large || size < small) {
    int shift = 0;
    mantissa = std::frexp(mantissa, &shift);
    exponent += shift;
  }
}

double SemiseparableSystem::Determinant::relativeTo(const Determinant &other) const {
  return std::ldexp(mantissa / other.mantissa, exponent - other.exponent);
}

bool SemiseparableSystem::factorise(const double *mass, int size, std::span<const Row> rows, std::span<const int> unknowns,
                                    std::span<const Friction> frictions) {
  mass_ = mass;
  sample_ = nullptr;
  size_ = size;
  rows_ = rows;
  unknowns_ = unknowns;
  frictions_ = frictions;
  isKnown_ = false;
  addEnds_.clear();
  listExpressed();
  order();
  sortByEnd(expressed_.size());
  adds_.assign(static_cast<std::size_t>(size_) + expressed_.size(), 0);
  rowSize_.assign(expressed_.size(), 0.0);
  return factoriseListed();
}

bool SemiseparableSystem::refactorise(const double *mass, std::span<const Row> rows) {
  mass_ = mass;
  sample_ = nullptr;
  replaceRows(rows);
  return factoriseListed();
}

bool SemiseparableSystem::refactorise(MassSample &sample, std::span<const Row> rows, double accuracy) {
  mass_ = nullptr;
  sample_ = &sample;
  replaceRows(rows);
  if (!findVectors() || !std::all_of(columns_.begin(), columns_.end(), [&sample](int column) { return sample.has(column); }))
    return false;
  return findDiagonal(accuracy) && factoriseVectors();
}

void SemiseparableSystem::replaceRows(std::span<const Row> rows) {
  rows_ = rows;
  isKnown_ = true;
  std::size_t k = 0;
  for (const int row : unknowns_)
    expressed_[k++] = rows_[row].entries;
  for (const Friction &friction : frictions_)
    expressed_[k++] = rows_[friction.row].entries;
}

bool SemiseparableSystem::factoriseListed() { return scaleColumns() && findVectors() && factoriseVectors(); }

bool SemiseparableSystem::factoriseVectors() {
  combine();
  return withVectors(count_, [this](auto vectors) { return eliminateAll<vectors()>(); });
}

// The rows of the unknowns, then those of the frictions, each at the end of its unknown: there is its place among the columns.
void SemiseparableSystem::listExpressed() {
  ends_.clear();
  for (const int row : unknowns_)
    ends_.push_back(rows_[row].end);
  for (const Friction &friction : frictions_)
    ends_[friction.unknown] = std::max(ends_[friction.unknown], rows_[friction.row].end);
  expressed_.clear();
  for (const int row : unknowns_)
    expressed_.push_back(rows_[row].entries);
  for (const Friction &friction : frictions_) {
    expressed_.push_back(rows_[friction.row].entries);
    ends_.push_back(ends_[friction.unknown]);
  }
}

bool SemiseparableSystem::scaleColumns() {
  scale_.resize(size_);
  root_.resize(size_);
  diagonal_.resize(size_);
  bool isPositive = true;
  for (int i = 0; i < size_; ++i) {
    const double diagonal = mass_[static_cast<std::ptrdiff_t>(i) * size_ + i];
    isPositive = isPositive && diagonal > 0 && diagonal <= std::numeric_limits<double>::max();
    if (!isKnown_) {
      root_[i] = std::sqrt(diagonal);
      scale_[i] = 1 / root_[i];
    }
    diagonal_[i] = diagonal * scale_[i] * scale_[i];
  }
  return isPositive;
}

const double *SemiseparableSystem::massColumn(int column) const {
  return sample_ != nullptr ? sample_->column(column) : mass_ + static_cast<std::ptrdiff_t>(column) * size_;
}

void SemiseparableSystem::noteColumn(int column) {
  if (std::find(columns_.begin(), columns_.end(), column) == columns_.end())
    columns_.push_back(column);
}

// Products of M as scaled, less its diagonal, which the vectors give, with L vectors: x and product [size × L].
template <int R, int L> void SemiseparableSystem::multiplyBeside(const double *x, double *product) const {
  const auto coefficientsOf = [](const std::vector<double> &all, int number) {
    return all.data() + static_cast<std::ptrdiff_t>(number) * mostVectors;
  };
  double sum[L][R] = {};
  for (int i = 0; i < size_; ++i) {
    const double *outer = coefficientsOf(outer_, i), *vector = coefficientsOf(vectors_, i);
    for (int lane = 0; lane < L; ++lane) {
      product[i * L + lane] = tf::runtime::product<R>(outer, sum[lane]);
      if (transition_[i] >= 0)
        turnForward<R>(transition_[i], sum[lane]);
      for (int k = 0; k < R; ++k)
        sum[lane][k] += vector[k] * x[i * L + lane];
    }
  }
  std::fill_n(&sum[0][0], L * R, 0.0);
  for (int i = size_ - 1; i >= 0; --i) {
    const double *outer = coefficientsOf(outer_, i), *vector = coefficientsOf(vectors_, i);
    for (int lane = 0; lane < L; ++lane) {
      product[i * L + lane] += tf::runtime::product<R>(vector, sum[lane]);
      if (transition_[i] >= 0)
        turnBack<R>(transition_[i], sum[lane]);
      for (int k = 0; k < R; ++k)
        sum[lane][k] += outer[k] * x[i * L + lane];
    }
  }
}

// Out of the first sum of the sample; the second one tells whether M is what the vectors make of it.
bool SemiseparableSystem::findDiagonal(double accuracy) {
  MassSample &sample = *sample_;
  const bool isFound = sample.hasDiagonal();
  if (!isFound) {
    constexpr int L = MassSample::sums;
    weights_.resize(static_cast<std::size_t>(size_) * L);
    products_.resize(weights_.size());
    for (int i = 0; i < size_; ++i)
      for (int k = 0; k < L; ++k)
        weights_[static_cast<std::size_t>(i) * L + k] = sample.weight(i, k) * root_[i];
    withVectors(count_, [this](auto vectors) { multiplyBeside<vectors(), L>(weights_.data(), products_.data()); });
    for (int i = 0; i < size_; ++i) {
      const double *weight = weights_.data() + static_cast<std::ptrdiff_t>(i) * L,
                   *beside = products_.data() + static_cast<std::ptrdiff_t>(i) * L;
      diagonal_[i] = (sample.sum(i, 0) * scale_[i] - beside[0]) / weight[0];
      const double rest = sample.sum(i, 1) * scale_[i] - beside[1] - diagonal_[i] * weight[1];
      if (!(std::abs(rest) <= accuracy))
        return false;
      sample.setDiagonal(i, diagonal_[i] * root_[i] * root_[i]);
    }
    sample.keepDiagonal();
  }
  bool isPositive = true;
  for (int i = 0; i < size_; ++i) {
    if (isFound)
      diagonal_[i] = sample.diagonal()[i] * scale_[i] * scale_[i];
    isPositive = isPositive && diagonal_[i] > 0;
  }
  return isPositive;
}

void SemiseparableSystem::sortByEnd(std::size_t count) {
  firstOfEnd_.assign(static_cast<std::size_t>(size_) + 2, 0);
  for (std::size_t k = 0; k < count; ++k)
    ++firstOfEnd_[ends_[k] + 1];
  std::partial_sum(firstOfEnd_.begin(), firstOfEnd_.end(), firstOfEnd_.begin());
  byEnd_.resize(count);
  for (std::size_t k = 0; k < count; ++k)
    byEnd_[firstOfEnd_[ends_[k]]++] = static_cast<int>(k);
}

// Rows of J and of M's lower triangle, those that reach furthest first: each adds a vector where those before do not make it up.
bool SemiseparableSystem::findVectors() {
  stride_ = paddedToLanes(size_);
  reduced_.resize(static_cast<std::size_t>(mostVectors) * stride_);
  std::fill_n(reduced_.data(), static_cast<std::ptrdiff_t>(isKnown_ ? count_ : mostVectors) * stride_, 0.0);
  rest_.resize(stride_);
  vectors_.resize(static_cast<std::size_t>(size_) * mostVectors);
  outer_.resize(vectors_.size());
  rowOuter_.resize(expressed_.size() * mostVectors);
  transition_.assign(size_, -1);
  transitions_.clear();
  columns_.clear();
  std::fill_n(pivot_, mostVectors, -1);
  std::fill_n(outer_.data(), mostVectors, 0.0);
  if (!isKnown_)
    count_ = 0;
  std::size_t adds = 0;  // of addEnds_
  for (int end = size_; end > 0; --end) {
    if (isKnown_) {
      const int last = std::max(adds < addEnds_.size() ? addEnds_[adds] : 0, *std::max_element(pivot_, pivot_ + mostVectors));
      if (last < end) {
        withVectors(count_, [&](auto vectors) { readCoefficients<vectors()>(last, end); });
        end = last + 1;
        continue;
      }
    }
    if (!findVectorsAt(end))
      return false;
    while (adds < addEnds_.size() && addEnds_[adds] >= end)
      ++adds;
  }
  return count_ > 0;
}

// Those of the rows that end after column end − 1.
bool SemiseparableSystem::findVectorsAt(int end) {
  isChanged_ = false;
  dropColumns(end);
  for (int k = firstOfEnd_[end - 1]; k < firstOfEnd_[end]; ++k)
    if (const int r = byEnd_[k];
        !express(expressed_[r], end, rowOuter_.data() + static_cast<std::ptrdiff_t>(r) * mostVectors, rowSize_[r], adds_[size_ + r]))
      return false;
  if (end < size_ && !expressMass(end))
    return false;
  keepColumn(end);
  return true;
}

// The row of M before its diagonal. M is read by columns.
bool SemiseparableSystem::expressMass(int end) {
  double *coefficients = outer_.data() + static_cast<std::ptrdiff_t>(end) * mostVectors, size = 0;
  if (!isKnown_ || adds_[end] != 0) {
    if (!express(massColumn(end), end, coefficients, size, adds_[end]))
      return false;
    if (adds_[end] != 0)
      noteColumn(end);
    return true;
  }
  std::fill_n(coefficients, mostVectors, 0.0);
  for (int k = 0; k < count_; ++k)
    if (pivot_[k] >= 0)
      coefficients[k] = massColumn(pivot_[k])[end] * scale_[pivot_[k]];
  return true;
}

// Of all rows that end after `last` and at `end` at the latest, where the vectors stay as they are. M is read by columns, as rows of it.
template <int R> void SemiseparableSystem::readCoefficients(int last, int end) {
  const auto coefficientsOf = [](std::vector<double> &all, int number) {
    return all.data() + static_cast<std::ptrdiff_t>(number) * mostVectors;
  };
  double *const outer = coefficientsOf(outer_, 0), *const vectors = coefficientsOf(vectors_, 0);
  const int lastRow = std::min(end, size_ - 1);
  for (int k = 0; k < R; ++k) {
    const int column = std::max(pivot_[k], 0);
    const double scale = pivot_[k] < 0 ? 0 : scale_[column];
    for (int place = firstOfEnd_[last]; place < firstOfEnd_[end]; ++place)
      coefficientsOf(rowOuter_, byEnd_[place])[k] = expressed_[byEnd_[place]][column] * scale;
    const double *masses = massColumn(column), *vector = reduced(k);
    for (int i = last + 1; i <= lastRow; ++i)
      outer[i * mostVectors + k] = masses[i] * scale * scale_[i];
    for (int j = last; j < end; ++j)
      vectors[j * mostVectors + k] = vector[j];
  }
}

// What the rows that end there have led to.
void SemiseparableSystem::keepColumn(int end) {
  for (int k = 0; k < mostVectors; ++k) {
    vectors_[static_cast<std::size_t>(end - 1) * mostVectors + k] = reduced(k)[end - 1];
    if (end < size_)
      outer_[static_cast<std::size_t>(end) * mostVectors + k] *= scale_[end];
  }
  if (!isChanged_ || end == size_)
    return;
  transition_[end] = static_cast<int>(transitions_.size()) / (mostVectors * mostVectors);
  transitions_.insert(transitions_.end(), &change_[0][0], &change_[0][0] + mostVectors * mostVectors);
}

// Columns from `end` on are reached by no row that is still to come.
void SemiseparableSystem::dropColumns(int end) {
  for (int k = 0; k < count_; ++k) {
    if (pivot_[k] < end)
      continue;
    double largest = 0;
    for (int j = 0; j < end; ++j)
      largest = std::max(largest, std::abs(reduced(k)[j]));
    if (largest > vanishing) {
      turn(k, pivotOf(reduced(k), end, largest), end);
      continue;
    }
    std::fill_n(reduced(k), end, 0.0);
    pivot_[k] = -1;
    turn(k, -1, end);
  }
}

// Vector k of the basis has its pivot in that column from now on; −1: it is no more. The vectors before are sums of those after: k by
// factor_[k], the others with factor_ times k.
void SemiseparableSystem::turn(int k, int column, int end) {
  if (!isChanged_)
    for (int i = 0; i < mostVectors; ++i)
      for (int j = 0; j < mostVectors; ++j)
        change_[i][j] = i == j && pivot_[i] >= 0;
  isChanged_ = true;
  std::fill_n(factor_, mostVectors, 0.0);
  if (column >= 0) {
    double *own = reduced(k);
    factor_[k] = own[column];
    const double inverse = 1 / own[column];
    for (int j = 0; j < end; ++j)
      own[j] *= inverse;
    own[column] = 1;
    pivot_[k] = column;
    noteColumn(column);
    for (int other = 0; other < count_; ++other) {
      if (other == k || pivot_[other] < 0)
        continue;
      double *vector = reduced(other);
      const double factor = factor_[other] = vector[column];
      for (int j = 0; j < end; ++j)
        vector[j] -= factor * own[j];
      vector[column] = 0;
    }
  }
  for (auto &row : change_)
    turnCoefficients(k, row);
}

// The same sum of vectors after the change.
void SemiseparableSystem::turnCoefficients(int k, double *coefficients) const {
  double sum = 0;
  for (int j = 0; j < mostVectors; ++j)
    sum += coefficients[j] * factor_[j];
  coefficients[k] = sum;
}

// The row as a sum of the vectors, one more of them where need be. False: too many.
bool SemiseparableSystem::express(const double *row, int end, double *coefficients, double &size, std::uint8_t &adds) {
  double factors[mostVectors];
  const double *parts[mostVectors];
  int used = 0;
  std::fill_n(coefficients, mostVectors, 0.0);
  for (int k = 0; k < count_; ++k) {
    if (pivot_[k] < 0)
      continue;
    coefficients[k] = factors[used] = row[pivot_[k]] * scale_[pivot_[k]];
    parts[used++] = reduced(k);
  }
  if (isKnown_ && adds == 0)
    return true;
  const RowRest rest = subtractRows(row, scale_.data(), factors, parts, used, end, rest_.data());
  size = rest.ofRow;
  if (!isKnown_ && !allFinite(rest_.data(), end))
    return false;
  if (rest.largest <= madeUp * rest.ofRow)
    return true;
  adds = 1;
  if (!isKnown_)
    addEnds_.push_back(end);
  const int k = static_cast<int>(std::find(pivot_, pivot_ + mostVectors, -1) - pivot_);
  if (k == mostVectors || !std::isfinite(rest.largest))
    return false;
  count_ = std::max(count_, k + 1);
  std::copy_n(rest_.data(), end, reduced(k));
  coefficients[k] = 1;
  turn(k, pivotOf(rest_.data(), end, rest.largest), end);
  // The rows of the same end, this one among them.
  for (int place = firstOfEnd_[end - 1]; place < firstOfEnd_[end]; ++place)
    turnCoefficients(k, rowOuter_.data() + static_cast<std::ptrdiff_t>(byEnd_[place]) * mostVectors);
  if (end < size_)
    turnCoefficients(k, outer_.data() + static_cast<std::ptrdiff_t>(end) * mostVectors);
  return true;
}

void SemiseparableSystem::order() {
  sortByEnd(unknowns_.size());
  order_.clear();
  int next = 0;
  for (int j = 0; j <= size_; ++j) {
    for (; next < firstOfEnd_[j]; ++next)
      order_.push_back(size_ + byEnd_[next]);
    if (j < size_)
      order_.push_back(j);
  }
}

// p and g of the unknowns, in their order.
void SemiseparableSystem::combine() {
  const std::size_t room = order_.size() * count_;
  row_.resize(room);
  column_.resize(room);
  left_.resize(room);
  right_.resize(room);
  forward_.resize(room * count_);
  back_.resize(room * count_);
  inverse_.resize(order_.size());
  std::vector<double> &force = correction_;  // f of the unknowns
  const auto outer = [this](std::size_t expressed) { return rowOuter_.data() + expressed * mostVectors; };
  force.resize(unknowns_.size() * count_);
  for (std::size_t u = 0; u < unknowns_.size(); ++u)
    std::copy_n(outer(u), count_, force.data() + u * count_);
  for (std::size_t f = 0; f < frictions_.size(); ++f)
    for (int k = 0; k < count_; ++k)
      force[static_cast<std::size_t>(frictions_[f].unknown) * count_ + k] += frictions_[f].factor * outer(unknowns_.size() + f)[k];
  for (std::size_t place = 0; place < order_.size(); ++place) {
    const int number = order_[place];
    double *row = row_.data() + place * count_, *column = column_.data() + place * count_;
    for (int k = 0; k < count_; ++k)
      if (number < size_) {
        row[k] = column[k] = outer_[static_cast<std::size_t>(number) * mostVectors + k];
      } else {
        const auto u = static_cast<std::size_t>(number - size_);
        row[k] = outer(u)[k];
        column[k] = -force[u * count_ + k];
      }
  }
}

// W of the basis before a column becomes that of the basis up to it.
template <int R> void SemiseparableSystem::pass(int number, double (&W)[R][R]) const {
  const double *change = transitions_.data() + static_cast<std::ptrdiff_t>(number) * mostVectors * mostVectors;
  double half[R][R];
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < R; ++j) {
      half[i][j] = 0;
      for (int k = 0; k < R; ++k)
        half[i][j] += W[i][k] * change[j * mostVectors + k];
    }
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < R; ++j) {
      W[i][j] = 0;
      for (int k = 0; k < R; ++k)
        W[i][j] += change[i * mostVectors + k] * half[k][j];
    }
}

// V of column `number` is added to the factors, which so far are of the basis before it, as W is.
template <int R>
[[gnu::always_inline]] inline void SemiseparableSystem::moveOn(int number, double (&m)[R], double (&l)[R], double (&W)[R][R]) const {
  if (const int transition = transition_[number]; transition >= 0) {
    pass<R>(transition, W);
    turnForward<R>(transition, m);
    turnForward<R>(transition, l);
  }
  const double *own = vectors_.data() + static_cast<std::ptrdiff_t>(number) * mostVectors;
  for (int i = 0; i < R; ++i) {
    m[i] += own[i];
    l[i] += own[i];
  }
}

// Out of the factors of one unknown.
template <int R>
[[gnu::always_inline]] inline void SemiseparableSystem::prepareSubstitution(std::size_t place, const double (&m)[R], const double (&l)[R]) {
  const int number = order_[place], transition = number < size_ ? transition_[number] : -1;
  const double inverse = inverse_[place], *p = row_.data() + place * R, *g = column_.data() + place * R;
  double *forward = forward_.data() + place * R * R, *back = back_.data() + place * R * R;
  for (int i = 0; i < R; ++i) {
    const double left = left_[place * R + i] = m[i] * inverse, right = right_[place * R + i] = l[i] * inverse;
    for (int j = 0; j < R; ++j) {
      forward[i * R + j] = (i == j) - left * p[j];
      back[j * R + i] = (i == j) - right * g[j];
    }
  }
  if (transition < 0)
    return;
  const double *change = transitions_.data() + static_cast<std::ptrdiff_t>(transition) * mostVectors * mostVectors;
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < R; ++j) {
      forward[i * R + j] += change[i * mostVectors + j] - (i == j);
      back[i * R + j] += change[j * mostVectors + i] - (i == j);
    }
}

// LU without exchanges. After some of the unknowns the entries that are left, of row i and column j behind them, are those of the matrix
// less p_i·W g_j; W is the mobility of what has been eliminated, as the next body feels it.
template <int R> bool SemiseparableSystem::eliminateAll() {
  double W[R][R] = {}, ofMass[R][R] = {}, m[R], l[R], size = 0;
  determinant_ = {};
  for (std::size_t place = 0; place < order_.size(); ++place) {
    const int number = order_[place];
    const bool isMass = number < size_;
    const double diagonal = isMass ? diagonal_[number] : 0, *p = row_.data() + place * R;
    const double pivot = findPivot<R>(W, p, column_.data() + place * R, diagonal, m, l, size);
    if (!(std::abs(pivot) > dependence_ * size))
      return false;
    const double inverse = inverse_[place] = 1 / pivot;
    if (isMass)
      moveOn<R>(number, m, l, W);
    addFactors<R>(m, l, inverse, W);
    prepareSubstitution<R>(place, m, l);
    if (!followsDeterminant_)
      continue;
    determinant_.multiply(pivot);
    if (!isMass)
      continue;
    const double massInverse = 1 / findPivot<R>(ofMass, p, p, diagonal, m, l, size);
    moveOn<R>(number, m, l, ofMass);
    addFactors<R>(m, l, massInverse, ofMass);
    determinant_.multiply(massInverse);
  }
  return true;
}

// S x of a transition.
template <int R> void SemiseparableSystem::turnForward(int number, double *x) const {
  const double *change = transitions_.data() + static_cast<std::ptrdiff_t>(number) * mostVectors * mostVectors;
  double turned[R];
  for (int i = 0; i < R; ++i)
    turned[i] = product<R>(change + static_cast<std::ptrdiff_t>(i) * mostVectors, x);
  std::copy_n(turned, R, x);
}

// Sᵀ x of a transition.
template <int R> void SemiseparableSystem::turnBack(int number, double *x) const {
  const double *change = transitions_.data() + static_cast<std::ptrdiff_t>(number) * mostVectors * mostVectors;
  double turned[R] = {};
  for (int i = 0; i < R; ++i)
    for (int j = 0; j < R; ++j)
      turned[j] += change[i * mostVectors + j] * x[i];
  std::copy_n(turned, R, x);
}

template <int R> void SemiseparableSystem::substitute(const double *rightHandSide, double *solution) const {
  double sum[R] = {};
  const std::size_t count = order_.size();
  const auto advance = [&sum](const double *matrix, const double *vector, double factor) {
    double next[R];
    for (int i = 0; i < R; ++i)
      next[i] = product<R>(matrix + static_cast<std::ptrdiff_t>(i) * R, sum) + vector[i] * factor;
    std::copy_n(next, R, sum);
  };
  for (std::size_t place = 0; place < count; ++place) {
    const int number = order_[place];
    solution[number] = (rightHandSide[number] - product<R>(row_.data() + place * R, sum)) * inverse_[place];
    advance(forward_.data() + place * R * R, left_.data() + place * R, rightHandSide[number]);
  }
  std::fill_n(sum, R, 0.0);
  for (std::size_t place = count; place-- > 0;) {
    const int number = order_[place];
    const double value = solution[number];
    solution[number] = value - product<R>(right_.data() + place * R, sum);
    advance(back_.data() + place * R * R, column_.data() + place * R, value);
  }
}

void SemiseparableSystem::solveOnce(const double *rightHandSide, double *solution) const {
  withVectors(count_, [&](auto vectors) { substitute<vectors()>(rightHandSide, solution); });
}

// rest −= M x
void SemiseparableSystem::subtractMassProduct(const double *x, double *rest) {
  if (sample_ == nullptr)
    return subtractProduct(mass_, size_, size_, x, rest);
  weights_.resize(std::max(weights_.size(), static_cast<std::size_t>(size_)));
  products_.resize(weights_.size());
  for (int i = 0; i < size_; ++i)
    weights_[i] = x[i] * root_[i];
  withVectors(count_, [this](auto vectors) { multiplyBeside<vectors(), 1>(weights_.data(), products_.data()); });
  for (int i = 0; i < size_; ++i)
    rest[i] -= (products_[i] + diagonal_[i] * weights_[i]) * root_[i];
}

// Right-hand sides less what the solution makes of them, of scaled rows, relative to what they are made of.
double SemiseparableSystem::findResidual(const double *force, const double *bias, const double *acceleration, const double *forces,
                                         Check check) {
  double *rest = residual_.data();
  rowProduct_.resize(rows_.size());
  if (check == Check::Everything) {
    rowForce_.assign(rows_.size(), 0.0);
    for (std::size_t u = 0; u < unknowns_.size(); ++u)
      rowForce_[unknowns_[u]] += forces[u];
    for (const Friction &friction : frictions_)
      rowForce_[friction.row] += friction.factor * forces[friction.unknown];
    std::copy_n(force, size_, rest);
    subtractMassProduct(acceleration, rest);
    for (std::size_t r = 0; r < rows_.size(); ++r)
      rowProduct_[r] = dotAndAdd(rows_[r].entries, acceleration, rowForce_[r], rest, size_);
  } else {
    std::fill_n(rest, size_, 0.0);
    for (const int r : unknowns_)
      rowProduct_[r] = denseDot(rows_[r].entries, acceleration, rows_[r].end);
  }
  double largest = 0, size = 0, rowError = 0, sum = 0;
  for (int i = 0; i < size_; ++i) {
    rest[i] *= scale_[i];
    sum += rest[i];
    largest = std::max(largest, std::abs(rest[i]));
    size = std::max({size, std::abs(force[i] * scale_[i]), std::abs(acceleration[i] * root_[i])});
  }
  for (std::size_t u = 0; u < unknowns_.size(); ++u) {
    const double value = -bias[u] - rowProduct_[unknowns_[u]];
    const double terms = std::abs(bias[u]) + rowSize_[u] * size;
    rest[size_ + static_cast<int>(u)] = value;
    sum += value;
    if (std::abs(value) > 0)
      rowError = std::max(rowError, std::abs(value) / terms);
  }
  // Which comparisons would pass over.
  if (!std::isfinite(sum))
    return std::numeric_limits<double>::infinity();
  return std::max(largest > 0 ? largest / size : 0, rowError);
}

bool SemiseparableSystem::solve(const double *force, const double *bias, double *acceleration, double *forces, double accuracy,
                                Check check) {
  constexpr double converging = 1e-7;  // what is left of such a residual by one more correction is rounding
  constexpr double credible = 1e-10;
  constexpr int mostCorrections = 3;
  const std::size_t unknowns = unknowns_.size(), count = static_cast<std::size_t>(size_) + unknowns;
  residual_.resize(count);
  correction_.resize(count);
  std::fill_n(acceleration, size_, 0.0);
  std::fill_n(forces, unknowns, 0.0);
  for (int i = 0; i < size_; ++i)
    residual_[i] = force[i] * scale_[i];
  for (std::size_t u = 0; u < unknowns; ++u)
    residual_[size_ + u] = -bias[u];
  double error = 1;
  for (int correction = 0; correction <= mostCorrections; ++correction) {
    solveOnce(residual_.data(), correction_.data());
    for (int i = 0; i < size_; ++i)
      acceleration[i] += correction_[i] * scale_[i];
    for (std::size_t u = 0; u < unknowns; ++u)
      forces[u] += correction_[size_ + u];
    if (correction > 0 && error <= converging)
      return true;
    error = findResidual(force, bias, acceleration, forces, check);
    if (error <= accuracy)
      return true;
    if (!(error < (isKnown_ ? credible : 1)))
      return false;
  }
  return false;
}

}  // namespace tf::runtime
