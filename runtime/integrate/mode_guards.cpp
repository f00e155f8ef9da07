// Guards of a mode: the functions whose zeros end it.
#include "runtime/integrate/mode_dynamics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

namespace tf::runtime {

void ModeDynamics::restartMargins() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::fill(leastMargins_.begin(), leastMargins_.end(), infinity);
  std::fill(largestMargins_.begin(), largestMargins_.end(), -infinity);
}

void ModeDynamics::recordMargins() {
  const auto values = marginValues();
  for (std::size_t k = 0; k < leastMargins_.size(); ++k) {
    if (values[k] < leastMargins_[k]) {
      leastMargins_[k] = values[k];
      leastMarginTimes_[k] = at_.time();
    }
    largestMargins_[k] = std::max(largestMargins_[k], values[k]);
  }
}

// Forces of a row are compared with those of all rows that act on one another: bodies that do not touch have their own. Where nothing is
// loaded, with a small part of what stops a velocity of its scale within a second. A slip at a dead centre would take a force beyond all
// others.
void ModeDynamics::scaleForces() {
  constexpr double unloaded = 1e-6;
  const int count = rows_.count(), normals = rows_.normalCount();
  const double least = settled_ != nullptr ? settled_->scale : 0;
  forceScale_.assign(count, -1.0);
  beginForce_ = 0;
  for (int first = 0; first < count; ++first) {
    if (forceScale_[first] >= 0)
      continue;
    group_.assign(1, first);
    double scale = least, ofSlips = 0;
    for (std::size_t k = 0; k < group_.size(); ++k) {
      const int row = group_[k], j = row - normals;
      const double speed =
          j < 0 ? at_.scales.gapRate(rows_.contacts()[row], at_.velocities()) : at_.scales.slip(rows_.tangents()[j], at_.velocities());
      const double response = problem_.delassus(row, row);
      const double stopping = response > 0 ? unloaded * speed / response : 0;
      double &largest = j >= 0 && contactMode_.slip[j] != 0 ? ofSlips : scale;
      largest = std::max(largest, stopping);
      scale = std::max(scale, std::abs(rowForces()[row]));
      forceScale_[row] = 0;
      for (int other = 0; other < count; ++other)
        if (forceScale_[other] < 0 && (problem_.delassus(other, row) != 0 || ownerOf(row) == ownerOf(other))) {
          forceScale_[other] = 0;
          group_.push_back(other);
        }
    }
    if (!(scale > 0) || ofSlips <= deadCentre * scale)
      scale = std::max(scale, ofSlips);
    for (const int row : group_)
      forceScale_[row] = scale;
    beginForce_ = std::max(beginForce_, scale);
  }
}

// The normal row of a row's contact; of a friction element's row that row.
int ModeDynamics::ownerOf(int row) const {
  const int j = row - rows_.normalCount();
  return j >= 0 && problem_.owner[j] >= 0 ? problem_.owner[j] : row;
}

void ModeDynamics::buildGuards() {
  const tf_model &model = at_.model();
  leastMargins_.assign(rows_.count() > 0 ? forces_.margins().size() : 0, -std::numeric_limits<double>::infinity());
  leastMarginTimes_.assign(leastMargins_.size(), 0);
  largestMargins_.assign(leastMargins_.size(), std::numeric_limits<double>::infinity());
  guards_.clear();
  const double *coordinates = at_.coordinates(), farthest = at_.scales.farthest(coordinates);
  for (int i = 0; i < model.nc; ++i)
    if (!mode_.closed[i])
      guards_.push_back({GuardKind::Gap, i, 1, at_.scales.gap(i, coordinates, farthest)});
  gapGuardCount_ = static_cast<int>(guards_.size());
  if (rows_.count() > 0)
    scaleForces();
  for (std::size_t k = 0; k < leastMargins_.size(); ++k) {
    const int row = forces_.margins()[k].limit.row;
    guards_.push_back({GuardKind::Force, static_cast<int>(k), 1, row >= 0 ? forceScale_[row] : beginForce_});
  }
  for (const int j : rows_.tangents())
    if (!isPaired_[j] && roles_[j] != TangentRole::Steady && mode_.tangent[j] != Tangent::Stick)
      guards_.push_back({GuardKind::Slip, j, mode_.tangent[j] == Tangent::SlipPositive ? 1.0 : -1.0, at_.scales.slip(j, at_.velocities())});
  for (int k = 0; k < slips_.count(); ++k)
    guards_.push_back({GuardKind::SlipAlong, k, 1, slips_.rounding(k) / 1e-12});
  for (int j = 0; j < model.ns; ++j) {
    if (const int of = model.switches[j].of; of >= 0) {
      // What leaves zero to the side that the other switch has is its own event.
      if (mode_.switches[j] == Switch::One)
        guards_.push_back({GuardKind::Condition, of, mode_.switches[of] == Switch::One ? -1.0 : 1.0, 1});
    } else if (mode_.switches[j] == Switch::Sliding) {
      guards_.push_back({GuardKind::StepLow, j, 1, 1});
      guards_.push_back({GuardKind::StepHigh, j, -1, 1});
    } else {
      guards_.push_back({GuardKind::Condition, j, mode_.switches[j] == Switch::One ? 1.0 : -1.0, 1});
    }
  }
  for (Guard &guard : guards_)
    guard.isHeld = guard.kind == GuardKind::Condition && !mode_.held.empty() && mode_.held[guard.index] != 0;
  guardsVary_ = false;
  for (std::size_t k = 0; model.variation != nullptr && k < guards_.size(); ++k) {
    guards_[k].varies = !guards_[k].isHeld && varies(guards_[k]);
    guardsVary_ = guardsVary_ || guards_[k].varies;
  }
}

bool ModeDynamics::varies(const Guard &guard) const {
  switch (guard.kind) {
  case GuardKind::Gap:
    return at_.gapVaries(guard.index);
  case GuardKind::Slip:
    return at_.slipVaries(guard.index);
  case GuardKind::SlipAlong:
    return at_.slipVaries(slips_.modelRow(guard.index)) || at_.slipVaries(slips_.modelRow(guard.index) + 1);
  case GuardKind::Condition:
    return at_.conditionVaries(guard.index);
  case GuardKind::Force:
    // What redundant rows contradict one another by comes with the positions, and is of the size of rounding until then.
    return at_.forcesVary() && forces_.margins()[guard.index].limit.row != ModeMargin::contradiction;
  case GuardKind::StepLow:
  case GuardKind::StepHigh:
    return at_.conditionVaries(guard.index) || at_.forcesVary();
  }
  return false;
}

double ModeDynamics::readGuard(const Guard &guard) const {
  switch (guard.kind) {
  case GuardKind::Gap:
    return at_.gap[guard.index];
  case GuardKind::Force:
    return marginValues()[guard.index];
  case GuardKind::Slip:
    return guard.sign * at_.slip[guard.index];
  case GuardKind::SlipAlong:
    return slips_.along(guard.index);
  case GuardKind::Condition:
    return guard.sign * at_.condition[guard.index];
  case GuardKind::StepLow:
    return at_.stepVariable[guard.index];
  case GuardKind::StepHigh:
    return 1 - at_.stepVariable[guard.index];
  }
  return 0;
}

double ModeDynamics::guardValue(int guard) {
  const Guard &g = guards_[guard];
  if (g.kind == GuardKind::Gap)
    at_.switchingOf(g.index);
  else if (g.kind == GuardKind::Slip || g.kind == GuardKind::SlipAlong)
    at_.switching(ModelEvaluation::Slips);
  else if (g.kind == GuardKind::Condition)
    at_.switching(ModelEvaluation::Conditions);
  return readGuard(g);
}

double ModeDynamics::slipRate(int guard) const {
  const Guard &g = guards_[guard];
  const auto nv = static_cast<std::size_t>(at_.model().nv), row = static_cast<std::size_t>(g.index);
  return g.sign * std::inner_product(at_.acceleration.begin(), at_.acceleration.end(),
                                     at_.tangent.begin() + static_cast<std::ptrdiff_t>(row * nv), at_.tangentBias[row]);
}

void ModeDynamics::evaluateGuards() {
  const tf_model &model = at_.model();
  int parts = 0;
  if (model.nc > 0)
    parts |= ModelEvaluation::Gaps;
  if (!rows_.tangents().empty())
    parts |= ModelEvaluation::Slips;
  if (model.ns > 0)
    parts |= ModelEvaluation::Conditions;
  if (parts != 0)
    at_.switching(parts);
}

void ModeDynamics::guardValues(double *values) {
  evaluateGuards();
  for (std::size_t k = 0; k < guards_.size(); ++k)
    values[k] = readGuard(guards_[k]);
}

double ModeDynamics::readRate(const Guard &guard) const {
  return guard.kind == GuardKind::Gap ? at_.gapRate[guard.index] : std::numeric_limits<double>::quiet_NaN();
}

void ModeDynamics::guardValues(std::span<const int> guards, double *values, double *rates) {
  evaluateGuards();
  for (const int k : guards) {
    values[k] = readGuard(guards_[k]);
    rates[k] = readRate(guards_[k]);
  }
}

bool ModeDynamics::isPole(int guard) const {
  if (isNearSharedPole(0))
    return true;
  const double begin = guards_[guard].scale;
  if (forces_.margins()[guards_[guard].index].limit.row != ModeMargin::pressing) {
    constexpr double zero = 0.1;  // near a pole that is not far from a zero, a projected state has forces of some such size
    return !(std::abs(readGuard(guards_[guard])) <= zero * begin);
  }
  // The determinant is ±1e-6 of what it was: so much larger are forces that have a pole.
  constexpr double finite = 1e3;
  return std::any_of(rowForces().begin(), rowForces().end(), [begin](double force) { return !(std::abs(force) <= finite * begin); });
}

bool ModeDynamics::isNearSharedPole(double part) const {
  return forces_.redundant() && forces_.mayPress() && marginValues().back() <= part * forces_.pressing().scale;
}

bool ModeDynamics::isAtPole() const {
  constexpr double rounding = 1e-9;  // of the determinant, relative to the begin of the mode
  return rows_.count() > 0 && forces_.mayPress() && marginValues().back() <= rounding * forces_.pressing().scale;
}

bool ModeDynamics::mayTurnBeyondPole() const {
  return !slips_.empty() && forces_.mayPress() && forces_.pressing().end == PressingMargin::before;
}

bool ModeDynamics::isClearOfPole() const {
  constexpr double clear = 1e-4;
  return marginValues().back() > clear * forces_.pressing().scale;
}

int ModeDynamics::contactOfMargin(int margin) const {
  const ModeMargin &m = forces_.margins()[margin];
  return !m.multiplier && m.limit.side == 0 && m.limit.row >= 0 && m.limit.row < rows_.normalCount() ? rows_.contacts()[m.limit.row] : -1;
}

void ModeDynamics::switchingValues(std::span<const int> guards, double *values, double *rates) {
  at_.switching(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  for (const int k : guards) {
    values[k] = guards_[k].kind == GuardKind::Gap || guards_[k].kind == GuardKind::Slip ? readGuard(guards_[k]) : 0;
    rates[k] = readRate(guards_[k]);
  }
}

double ModeDynamics::projectStart(double time, double *state, const double *scale) {
  stops_ = nothingStops_;
  bool isAny = false;
  for (int pair = 0; pair < slips_.count(); ++pair)
    if (slips_.isGiven(pair)) {
      stopPair(pair);
      isAny = true;
    }
  if (!isAny)
    return project(time, state, scale);
  completeRows();
  return projection_.project(time, state, scale, stops_.data());
}

double ModeDynamics::projectStop(double time, double *state, const double *scale, int stopped, double part) {
  completeRows();
  at_.setPoint(time, state);
  at_.switching(ModelEvaluation::Slips);
  stops_ = nothingStops_;
  for (int pair = 0; pair < slips_.count(); ++pair)
    if (pair == guards_[stopped].index || slips_.speed(pair) <= part * slips_.scale(pair))
      stopPair(pair);
  return projection_.project(time, state, scale, stops_.data());
}

bool ModeDynamics::rechoose(int guard) {
  assert(guards_[guard].kind == GuardKind::Force);
  complete();
  if (forces_.cross(guards_[guard].index) != MarginOutcome::Rechosen)
    return false;
  chooseLinked();
  buildGuards();
  return true;
}

void ModeDynamics::acceptContradiction() {
  if (forces_.redundant())
    forces_.acceptContradiction();
}

}  // namespace tf::runtime
