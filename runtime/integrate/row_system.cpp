#include "runtime/integrate/row_system.h"

#include "runtime/contact/dense_kernels.h"
#include "runtime/contact/irregular_numbers.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>

namespace tf::runtime {

namespace {

// Zeros are looked for in so many entries at once.
constexpr int chunk = 8;

// By the bits but that of the sign.
bool allZero(const double *x) {
  std::uint64_t bits[chunk], any = 0;
  std::memcpy(bits, x, sizeof bits);
  for (const std::uint64_t own : bits)
    any |= own;
  return any << 1 == 0;
}

int leadingZeros(const double *x, int count) {
  int k = 0;
  while (k + chunk <= count && allZero(x + k))
    k += chunk;
  while (k < count && x[k] == 0)
    ++k;
  return k;
}

int trailingZeros(const double *x, int count) {
  int k = count;
  while (k >= chunk && allZero(x + k - chunk))
    k -= chunk;
  while (k > 0 && x[k - 1] == 0)
    --k;
  return count - k;
}

// Of the entries of rows, relative to the largest.
constexpr double rounding = 1e-13;

}  // namespace

bool RowSystem::areEqual(const double *x, const double *y, int count) {
  const Difference difference = largestDifference(x, y, count);
  return difference.largest <= rounding * difference.ofFirst;
}

void RowSystem::choose(const tf_model &model, const std::vector<int> &contacts, const std::vector<int> &tangents, ContactRows &problem) {
  contacts_ = contacts;
  tangents_ = tangents;
  normalCount_ = static_cast<int>(contacts.size());
  count_ = normalCount_ + static_cast<int>(tangents.size());
  nv_ = model.nv;
  jacobian_.resize(static_cast<std::size_t>(count()) * nv_);
  half_.resize(jacobian_.size());
  scaled_.resize(jacobian_.size());
  mobility_ = nullptr;  // until the rows are assembled: those of before are no more
  sum_.resize(nv_);
  zero_.resize(nv_);
  hasTwins_ = false;
  if (nv_ > narrow)
    prepareTwins();
  spans_.assign(count(), Span{0, nv_});
  firstSpan_.resize(static_cast<std::size_t>(count()) + 1);
  std::iota(firstSpan_.begin(), firstSpan_.end(), 0);
  contactOf_.clear();
  side_.clear();
  frame_.assign(tangents.size(), Frame{});
  if (owner_.empty() && !tangents_.empty()) {
    owner_ = contactsOfTangents(model);
    pair_ = pairsOfTangents(model);
  }
  for (std::size_t j = 0; j < tangents_.size(); ++j) {
    contactOf_.push_back(owner_[tangents_[j]]);
    side_.push_back(pair_[tangents_[j]] < 0 ? 0 : pair_[tangents_[j]] == tangents_[j] ? 1 : 2);
    problem.partner[j] = side_[j] == 0 ? -1 : static_cast<int>(j) + (side_[j] == 1 ? 1 : -1);
    if (contactOf_[j] < 0) {
      problem.owner[j] = -1;
      continue;
    }
    const auto place = std::find(contacts_.begin(), contacts_.end(), contactOf_[j]);
    assert(place != contacts_.end());
    problem.owner[j] = static_cast<int>(place - contacts_.begin());
  }
}

// Of the row that is gathered next. Runs of zeros part it where they fill chunks, counted from its first entry.
void RowSystem::findSpans(int i) {
  const double *row = jacobian(i);
  const int begin = leadingZeros(row, nv_), end = nv_ - trailingZeros(row + begin, nv_ - begin);
  bool continues = false;
  for (int k = begin; k < end; k += chunk) {
    const int next = std::min(k + chunk, end);
    const bool isZero = next == k + chunk && allZero(row + k);
    if (continues && !isZero)
      spans_.back().end = next;
    else if (!isZero)
      spans_.push_back({k, next});
    continues = !isZero;
  }
  firstSpan_.push_back(static_cast<int>(spans_.size()));
}

void RowSystem::prepareTwins() {
  twin_.resize(count());
  mark_.resize(count());
  first_.reserve(count());
  twinForce_.resize(count());
  while (static_cast<int>(marker_.size()) < nv_)
    marker_.push_back(irregularNumber(static_cast<int>(marker_.size())));
}

// Only rows are compared whose products with a vector of no regularity are equal, too. A pair that is missed costs time only.
void RowSystem::findTwin(int i, double mark) {
  constexpr double similar = 1e-12;
  const double *row = jacobian(i);
  const double accepted = similar * std::abs(mark);
  const int count = static_cast<int>(first_.size()), end = endOf(i);
  twin_[i] = i;
  for (int k = firstWithin(mark_.data(), 0, count, mark, accepted); k < count; k = firstWithin(mark_.data(), k + 1, count, mark, accepted))
    if (areEqual(row, jacobian(first_[k]), std::max(end, endOf(first_[k])))) {
      twin_[i] = first_[k];
      return;
    }
  mark_[count] = mark;
  first_.push_back(i);
}

// Rows are read as a whole where that costs no more than looking for their zeros.
void RowSystem::gatherRows(const ModelEvaluation &at) {
  const int n = normalCount(), m = count();
  const bool isNarrow = nv_ <= narrow;
  if (!isNarrow) {
    first_.clear();
    spans_.clear();
    firstSpan_.assign(1, 0);
  }
  for (int i = 0; i < m; ++i) {
    double *row = jacobian_.data() + static_cast<std::ptrdiff_t>(i) * nv_;
    const double *source = modelRow(at, i);
    if (source == nullptr) {
      for (int k = 0; k < nv_; ++k)
        row[k] = tangentValue(at.tangent.data() + k, nv_, i - n);
      source = row;
    }
    if (isNarrow) {
      for (int k = 0; k < nv_; ++k)
        row[k] = source[k];
      continue;
    }
    const double mark = copyAndWeigh(source, marker_.data(), nv_, row);
    findSpans(i);
    findTwin(i, mark);
  }
  hasTwins_ = !isNarrow && static_cast<int>(first_.size()) < m;
}

void RowSystem::gatherLimits(const ModelEvaluation &at, ContactRows &rows) const {
  for (int j = 0; j < static_cast<int>(tangents_.size()); ++j) {
    if (contactOf_[j] >= 0)
      rows.friction[j] = at.friction[contactOf_[j]];
    else
      rows.bound[j] = at.bound[tangents_[j]];
    if (rows.isAcross(j))
      rows.friction[j] = rows.bound[j] = 0;
  }
}

// Z of row i on the blocks that it moves.
void RowSystem::halve(int i) {
  const double *row = jacobian(i);
  double *half = half_.data() + static_cast<std::ptrdiff_t>(i) * nv_, *scaled = scaled_.data() + static_cast<std::ptrdiff_t>(i) * nv_;
  const MassMatrix &mass = mobility_->mass();
  const bool everywhere = mobility_->isConstrained();
  const int blocks = static_cast<int>(mass.blocks().size());
  const auto add = [&](int block) {
    const bool waits = mass.isLarge(block) && !everywhere;
    const int first = waits ? 0 : mass.forward(block, row, half, scaled);
    parts_[block].push_back({i, waits || everywhere ? mass.blocks()[block].begin : first});
  };
  if (everywhere || blocks == 1)
    for (int block = 0; block < blocks; ++block)
      add(block);
  else
    for (const Span &span : spansOf(i))
      for (int k = span.begin; k < span.end; ++k)
        if (const int block = mass.blockOf(k); row[k] != 0 && (parts_[block].empty() || parts_[block].back().row != i))
          add(block);
  if (everywhere)
    mobility_->constrain(row, half, scaled);
}

void RowSystem::halvePanel(int block) {
  const MassMatrix &mass = mobility_->mass();
  const MassMatrix::Block &places = mass.blocks()[block];
  const std::vector<Part> &parts = parts_[block];
  Panel &panel = panels_[block];
  panel.stride = paddedToLanes(static_cast<int>(parts.size()));
  panel.half.resize(static_cast<std::size_t>(places.end - places.begin) * panel.stride);
  panel.scaled.resize(panel.half.size());
  for (int a = 0; a < panel.stride; a += panelLanes) {
    const double *rows[panelLanes];
    for (int lane = 0; lane < panelLanes; ++lane)
      rows[lane] = a + lane < static_cast<int>(parts.size()) ? jacobian(parts[a + lane].row) : zero_.data();
    double *half = panel.half.data() + a;
    for (int place = places.begin; place < places.end; ++place, half += panel.stride)
      for (int lane = 0; lane < panelLanes; ++lane)
        half[lane] = rows[lane][mass.rowAt(place)];
  }
  mass.forwardPanel(block, panel.stride, panel.half.data());
  for (int place = places.begin; place < places.end; ++place) {
    const double inverse = mass.inverseAt(place);
    const double *half = panel.half.data() + static_cast<std::ptrdiff_t>(place - places.begin) * panel.stride;
    double *scaled = panel.scaled.data() + (half - panel.half.data());
    for (int a = 0; a < panel.stride; ++a)
      scaled[a] = half[a] * inverse;
  }
}

void RowSystem::multiplyPanel(int block, DenseMatrix &delassus) {
  const MassMatrix::Block &places = mobility_->mass().blocks()[block];
  const std::vector<Part> &parts = parts_[block];
  const Panel &panel = panels_[block];
  product_.resize(static_cast<std::size_t>(panel.stride) * panel.stride);
  multiplyPanels(panel.half.data(), panel.scaled.data(), places.end - places.begin, panel.stride, product_.data());
  for (std::size_t a = 0; a < parts.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b)
      delassus(parts[b].row, parts[a].row) += product_[a * panel.stride + b];
}

void RowSystem::multiply(DenseMatrix &delassus) {
  const int m = count();
  if (hasTwins_)
    for (const int j : first_)
      std::fill_n(delassus.column(j), m, 0.0);
  else
    std::fill_n(delassus.data(), static_cast<std::ptrdiff_t>(m) * m, 0.0);
  for (std::size_t block = 0; block < parts_.size(); ++block) {
    const int end = mobility_->mass().blocks()[block].end;
    const std::vector<Part> &parts = parts_[block];
    if (isPanel(static_cast<int>(block))) {
      multiplyPanel(static_cast<int>(block), delassus);
      continue;
    }
    for (std::size_t a = 0; a < parts.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        const int first = std::max(parts[a].first, parts[b].first);
        const std::ptrdiff_t left = static_cast<std::ptrdiff_t>(parts[a].row) * nv_ + first;
        const std::ptrdiff_t right = static_cast<std::ptrdiff_t>(parts[b].row) * nv_ + first;
        delassus(parts[b].row, parts[a].row) += dot(half_.data() + left, scaled_.data() + right, end - first);
      }
  }
  if (hasTwins_)
    copyTwins(delassus);
  else
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < j; ++i)
        delassus(j, i) = delassus(i, j);
}

// What is above the diagonal, of the first of equal rows, to everywhere else.
void RowSystem::copyTwins(DenseMatrix &delassus) const {
  const int m = count();
  for (const int j : first_)
    for (int i = 0; i < j; ++i)
      delassus(j, i) = delassus(i, j);
  for (int i = 0; i < m; ++i)
    if (twin_[i] != i)
      for (const int j : first_)
        delassus(i, j) = delassus(twin_[i], j);
  for (int j = 0; j < m; ++j)
    if (twin_[j] != j)
      std::copy_n(delassus.column(twin_[j]), m, delassus.column(j));
}

// All rows as a whole.
void RowSystem::respondAsWhole(DenseMatrix &delassus) {
  const int m = count();
  const MassMatrix &mass = mobility_->mass();
  for (int i = 0; i < m; ++i) {
    double *half = half_.data() + static_cast<std::ptrdiff_t>(i) * nv_, *scaled = scaled_.data() + static_cast<std::ptrdiff_t>(i) * nv_;
    mass.forward(jacobian(i), half, scaled);
    if (mobility_->isConstrained())
      mobility_->constrain(jacobian(i), half, scaled);
    double *column = delassus.column(i);
    for (int j = 0; j <= i; ++j)
      column[j] = delassus(i, j) = dot(half, scaled_.data() + static_cast<std::ptrdiff_t>(j) * nv_, nv_);
  }
}

void RowSystem::respond(const ModelEvaluation &at, DenseMatrix &delassus) {
  mobility_ = &at.mobility;
  if (isWhole())
    return respondAsWhole(delassus);
  parts_.resize(mobility_->mass().blocks().size());
  for (std::vector<Part> &parts : parts_)
    parts.clear();
  panels_.resize(parts_.size());
  if (hasTwins_)
    for (const int i : first_)
      halve(i);
  else
    for (int i = 0; i < count(); ++i)
      halve(i);
  for (int block = 0; block < static_cast<int>(parts_.size()); ++block)
    if (isPanel(block) && !parts_[block].empty())
      halvePanel(block);
  multiply(delassus);
}

double RowSystem::tangentValue(const double *modelRows, int stride, int j) const {
  const double own = modelRows[tangents_[j] * stride];
  if (side_[j] == 0)
    return own;
  if (side_[j] == 1)
    return frame_[j].c * own + frame_[j].s * modelRows[tangents_[j + 1] * stride];
  return frame_[j - 1].c * own - frame_[j - 1].s * modelRows[tangents_[j - 1] * stride];
}

// Of row j of a pair, whose rows are in a frame.
void RowSystem::spreadTurned(int j, const double *forces, double *modelForces) const {
  if (side_[j] != 1)
    return;
  const Frame &frame = frame_[j];
  modelForces[tangents_[j]] = frame.c * forces[j] - frame.s * forces[j + 1];
  modelForces[tangents_[j + 1]] = frame.s * forces[j] + frame.c * forces[j + 1];
}

void RowSystem::bias(const ModelEvaluation &at, const double *freeAcceleration, std::vector<double> &bias) const {
  for (int i = 0; i < count(); ++i)
    bias[i] = product(i, freeAcceleration) + modelBias(at, i);
}

// Δ⁻¹ Z of one block times the forces into sum_; false where they are zero.
bool RowSystem::addPanel(int block, const double *forces) const {
  const MassMatrix::Block &places = mobility_->mass().blocks()[block];
  const std::vector<Part> &parts = parts_[block];
  bool any = false;
  panelForce_.resize(parts.size());
  for (std::size_t a = 0; a < parts.size(); ++a) {
    panelForce_[a] = forces[parts[a].row];
    any = any || panelForce_[a] != 0;
  }
  const Panel &panel = panels_[block];
  for (int place = places.begin; any && place < places.end; ++place)
    sum_[place] = denseDot(panel.scaled.data() + static_cast<std::ptrdiff_t>(place - places.begin) * panel.stride, panelForce_.data(),
                           static_cast<int>(parts.size()));
  return any;
}

// The forces with those of equal rows on the first of them.
const double *RowSystem::sumOverTwins(const double *forces) const {
  if (!hasTwins_)
    return forces;
  std::copy_n(forces, count(), twinForce_.begin());
  for (int i = 0; i < count(); ++i)
    if (twin_[i] != i)
      twinForce_[twin_[i]] += forces[i];
  return twinForce_.data();
}

// Δ⁻¹ Z times the forces into sum_; false where they are zero.
bool RowSystem::sumAsWhole(const double *forces) const {
  bool any = false;
  for (int i = 0; i < count(); ++i) {
    if (forces[i] == 0)
      continue;
    any = true;
    const double *row = scaled_.data() + static_cast<std::ptrdiff_t>(i) * nv_;
    for (int k = 0; k < nv_; ++k)
      sum_[k] += row[k] * forces[i];
  }
  return any;
}

// The same, block by block.
bool RowSystem::sumBlocks(const double *forces) const {
  bool any = false;
  for (std::size_t block = 0; block < parts_.size(); ++block) {
    const int end = mobility_->mass().blocks()[block].end;
    if (isPanel(static_cast<int>(block))) {
      any = addPanel(static_cast<int>(block), forces) || any;
      continue;
    }
    for (const Part &part : parts_[block]) {
      const double force = forces[part.row];
      if (force == 0)
        continue;
      any = true;
      const double *row = scaled_.data() + static_cast<std::ptrdiff_t>(part.row) * nv_;
      for (int k = part.first; k < end; ++k)
        sum_[k] += row[k] * force;
    }
  }
  return any;
}

void RowSystem::accelerate(const double *forces, double *acceleration) const {
  if (mobility_ == nullptr)
    return;
  forces = sumOverTwins(forces);
  std::fill(sum_.begin(), sum_.end(), 0.0);
  if (isWhole() ? sumAsWhole(forces) : sumBlocks(forces))
    mobility_->mass().addBackward(sum_.data(), acceleration);
}

void RowSystem::addForces(const double *forces, double *target) const {
  for (int i = 0; i < count(); ++i)
    addForce(i, forces[i], target);
}

}  // namespace tf::runtime
