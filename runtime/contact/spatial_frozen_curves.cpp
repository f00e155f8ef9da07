// Pieces on which the directions of slips turn: integrated to rounding, with their ends located inside the steps.
#include "runtime/contact/spatial_frozen_workspace.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

void SpatialFrozenPhase::Workspace::listWatches() {
  watches.clear();
  for (int i = 0; i < n; ++i) {
    if (mode.normal[i] == FrozenMode::Normal::Held) {
      watches.push_back({Watch::Kind::HeldLow, i, 1});
      watches.push_back({Watch::Kind::HeldHigh, i, 1});
    } else if (restsAt(i)) {
      watches.push_back({Watch::Kind::Normal, i, mode.normal[i] == FrozenMode::Normal::Push ? -1.0 : 1.0, roundingSpeed});
    } else {
      const double v = velocity[i] != 0 ? velocity[i] : acceleration[i];
      watches.push_back({Watch::Kind::Normal, i, v >= 0 ? 1.0 : -1.0});
    }
    if (!restitution.stored(i) || velocity[i] < 0)
      continue;
    if (problem->law[i] == ImpactLaw::Poisson)
      watches.push_back({Watch::Kind::StoredImpulse, i, 1});
    if (restitution.endsByWork(i))
      watches.push_back({Watch::Kind::StoredWork, i, 1});
  }
  for (int j = 0; j < m; ++j) {
    if (isSecond(j))
      continue;
    if (mode.tangent[j] == FrozenMode::Tangent::Stick)
      watches.push_back({Watch::Kind::Stick, j, 1});
    else if (mode.tangent[j] == FrozenMode::Tangent::Slip)
      watches.push_back({isPair(j) ? Watch::Kind::PairSlip : Watch::Kind::Slip, j, static_cast<double>(mode.sign[j]),
                         isPair(j) && slipSpeed(j, velocity) <= stillSpeed ? stillSpeed : 0.0});
  }
}

// At `point` and `pointForce`, the end of the last step integrated.
double SpatialFrozenPhase::Workspace::value(const Watch &watch, double duration) const {
  const int i = watch.index, row = n + i;
  switch (watch.kind) {
  case Watch::Kind::Normal:
    return watch.sign * point[i] + watch.level;
  case Watch::Kind::Slip:
    return watch.sign * point[row];
  case Watch::Kind::PairSlip:
    return mode.direction[i] * point[row] + mode.direction[i + 1] * point[row + 1] + watch.level;
  case Watch::Kind::HeldLow:
    return pointForce[i];
  case Watch::Kind::HeldHigh:
    return problem->rate[i] - pointForce[i];
  case Watch::Kind::Stick:
    return problem->friction[i] * pointForce[problem->owner[i]] -
           (isPair(i) ? std::hypot(pointForce[row], pointForce[row + 1]) : std::abs(pointForce[row]));
  case Watch::Kind::StoredImpulse:
    return restitution.impulse(i) - problem->rate[i] * duration;
  case Watch::Kind::StoredWork:
    return restitution.work(i) - problem->rate[i] * state[n + m + i];
  }
  return 0;
}

double SpatialFrozenPhase::Workspace::responsiveness() const {
  double largest = 1e-300;
  for (int r = 0; r < n + m; ++r)
    largest = std::max(largest, problem->delassus(r, r));
  return largest;
}

// `point` and `pointForce` at y, and y'.
bool SpatialFrozenPhase::Workspace::rate(const Eigen::VectorXd &y, Eigen::VectorXd &f) {
  const int count = n + m;
  point = velocity;
  Eigen::Map<Eigen::VectorXd>(point.data(), count).noalias() += problem->delassus.map() * y.head(count);
  if (!mode.forces(*problem, point, stillSpeed, pointForce))
    return false;
  f.resize(count + n);
  std::copy(pointForce.begin(), pointForce.end(), f.data());
  std::copy_n(point.begin(), n, f.data() + count);
  return true;
}

// Forces depend on the slips of the pairs that slip alone: their derivatives, by differences. A slip that starts is stiffest where it
// leaves its reference direction, soon after a begin where it is not stiff at all.
bool SpatialFrozenPhase::Workspace::linearise() {
  const double increment = 0.1 * stillSpeed;
  std::vector<double> base = velocity;
  bool anyStarts = false;
  for (int j = 0; j < m; ++j)
    if (isPair(j) && mode.tangent[j] == FrozenMode::Tangent::Slip && slipSpeed(j, velocity) < stillSpeed) {
      anyStarts = true;
      for (const int k : {j, j + 1})
        base[n + k] = stillSpeed * mode.direction[k];
    }
  turning.clear();
  for (int j = 0; j < m; ++j)
    if (mode.tangent[j] == FrozenMode::Tangent::Slip && problem->partner[j] >= 0)
      turning.push_back(n + j);
  const auto count = static_cast<Eigen::Index>(turning.size());
  Eigen::VectorXd firstRate;
  if (!rate(zeroState, firstRate))
    return false;
  integrator.start(zeroState, firstRate);
  if (anyStarts && !mode.forces(*problem, base, stillSpeed, pointForce))
    return false;
  const std::vector<double> baseForce = pointForce;
  forceByTurn.resize(n + m, count);
  turnByForce.resize(count, n + m);
  for (Eigen::Index k = 0; k < count; ++k) {
    point = base;
    point[turning[k]] += increment;
    if (!mode.forces(*problem, point, stillSpeed, pointForce))
      return false;
    forceByTurn.col(k) =
        (Eigen::Map<const Eigen::VectorXd>(pointForce.data(), n + m) - Eigen::Map<const Eigen::VectorXd>(baseForce.data(), n + m)) /
        increment;
    turnByForce.row(k) = problem->delassus.map().row(turning[k]);
  }
  turnByTurn = turnByForce * forceByTurn;
  return true;
}

bool SpatialFrozenPhase::Workspace::factor(double part) {
  stepPart = part;
  const auto size = static_cast<int>(turnByTurn.rows());
  turnFactor.matrix().resize(size, size);
  turnFactor.matrix().map() = -part * turnByTurn;
  turnFactor.matrix().map().diagonal().array() += 1;
  return size == 0 || turnFactor.factor(0);
}

// By the matrix inversion lemma: the derivative of P' by P is forceByTurn · turnByForce.
void SpatialFrozenPhase::Workspace::solve(Eigen::VectorXd &x) {
  const int count = n + m;
  if (!turning.empty()) {
    turned.noalias() = turnByForce * x.head(count);
    turnFactor.solve(turned.data());
    x.head(count).noalias() += stepPart * (forceByTurn * turned);
  }
  x.tail(n).noalias() += stepPart * (problem->delassus.map().topRows(n) * x.head(count));
}

// From `velocity` over h, after integrator.start: `state`, `point` and `pointForce`. False: the step is too long.
bool SpatialFrozenPhase::Workspace::integrate(double h) {
  if (h == integratedLength)
    return isIntegrated;
  const bool good = integrator.step(h, accuracy * scale / responsiveness(), *this);
  state = integrator.end();
  Eigen::VectorXd ignored;
  integratedLength = h;
  return isIntegrated = rate(state, ignored) && good;
}

// d value/dh at the end of the last step; NaN for forces.
double SpatialFrozenPhase::Workspace::slope(const Watch &watch) const {
  const int i = watch.index, row = n + i;
  const auto change = [this](int r) {
    return problem->delassus.map().col(r).dot(Eigen::Map<const Eigen::VectorXd>(pointForce.data(), n + m));
  };
  switch (watch.kind) {
  case Watch::Kind::Normal:
    return watch.sign * change(i);
  case Watch::Kind::Slip:
    return watch.sign * change(row);
  case Watch::Kind::PairSlip:
    return mode.direction[i] * change(row) + mode.direction[i + 1] * change(row + 1);
  case Watch::Kind::StoredImpulse:
    return -problem->rate[i];
  case Watch::Kind::StoredWork:
    return -problem->rate[i] * point[i];
  case Watch::Kind::HeldLow:
  case Watch::Kind::HeldHigh:
  case Watch::Kind::Stick:
    break;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

// What the value is rounded relative to.
double SpatialFrozenPhase::Workspace::sizeOf(const Watch &watch) const {
  switch (watch.kind) {
  case Watch::Kind::HeldLow:
  case Watch::Kind::HeldHigh:
    return problem->rate[watch.index];
  case Watch::Kind::Stick:
    return problem->friction[watch.index] * problem->rate[problem->owner[watch.index]];
  case Watch::Kind::Normal:
  case Watch::Kind::Slip:
  case Watch::Kind::PairSlip:
  case Watch::Kind::StoredImpulse:
  case Watch::Kind::StoredWork:
    break;
  }
  return scale;
}

// The length of the step at whose end the value is zero: it is positive for short steps and negative at `high`, the last one. Newton's
// method where the slope is known, else regula falsi (Illinois). 0: shorter steps fail.
double SpatialFrozenPhase::Workspace::locate(const Watch &watch, double high) {
  constexpr double resolution = 2e-16;
  const double rounding = 1e-16 * sizeOf(watch);
  double low = 0, lowValue = 0, x = high, v = value(watch, high), highValue = v;
  bool known = false;  // the value at `low`
  int side = 0;
  // Forces may be beyond their limits by rounding from the begin on.
  if (const double begin = instant * scale / largestChange; std::isnan(slope(watch))) {
    if (high <= begin)
      return high;
    known = integrate(begin) || nearlyIntegrated();
    low = known ? begin : 0;
    lowValue = known ? value(watch, begin) : 0;
    if (lowValue < 0)
      return begin;
  }
  for (int k = 0; k < 100 && high - low > resolution * high; ++k) {
    const double correction = -v / slope(watch);
    if (std::abs(correction) <= resolution * x)
      return x;
    double next = x + correction;
    if (!(next > low && next < high))
      next = known ? (lowValue * high - highValue * low) / (lowValue - highValue) : 0.5 * (low + high);
    if (!(next > low && next < high))
      next = 0.5 * (low + high);
    x = next;
    if (!integrate(x) && !nearlyIntegrated())
      return 0;
    v = value(watch, x);
    if (std::abs(v) <= rounding)
      return x;
    if (v > 0) {
      low = x;
      lowValue = v;
      known = true;
      highValue *= side == 1 ? 0.5 : 1;
      side = 1;
    } else {
      high = x;
      highValue = v;
      lowValue *= side == -1 ? 0.5 : 1;
      side = -1;
    }
  }
  return high;
}

// The step's end becomes the state. Contacts at zero without an own force store nothing, and what moves them within rounding is no motion.
void SpatialFrozenPhase::Workspace::commit(double h, const Watch *event) {
  // Of a force that has been at its limit from the begin on: nothing changes, and the mean of no time is none.
  const bool isInstant = h * largestChange <= instant * scale;
  for (int i = 0; i < n; ++i) {
    if (restsAt(i) && (mode.normal[i] != FrozenMode::Normal::Push || std::abs(point[i]) <= roundingSpeed))
      continue;
    const bool exhausted =
        event != nullptr && (event->kind == Watch::Kind::StoredImpulse || event->kind == Watch::Kind::StoredWork) && event->index == i;
    if (isInstant && !exhausted)
      continue;
    // The straight piece with the same begin and the same integral of the velocity stores the same.
    const double mean = 2 * (state[n + m + i] - velocity[i] * h) / (h * h);
    restitution.advance(i, velocity[i], mean, h, exhausted);
  }
  for (int r = 0; r < n + m; ++r) {
    impulse[r] += state[r];
    const bool zero = r < n ? mode.normal[r] == FrozenMode::Normal::Held || (restsAt(r) && std::abs(point[r]) <= roundingSpeed)
                            : mode.tangent[r - n] == FrozenMode::Tangent::Stick;
    velocity[r] = zero ? 0 : point[r];
  }
  tau += h;
}

// A slip whose part along its direction at the step's begin is zero: has it come to rest, or turned? Then a shorter step follows it.
bool SpatialFrozenPhase::Workspace::settleStop(const Watch &event, double &h, bool &found) {
  if (event.kind != Watch::Kind::PairSlip || slipSpeed(event.index, point) <= 5 * stillSpeed)
    return true;
  found = false;
  for (int k = 0; k < 100; ++k) {
    h *= 0.7;
    if (integrate(h) && value(event, h) >= 0.5 * slipSpeed(event.index, point))
      return true;
  }
  return false;
}

// The first event in the step h, which becomes its end.
SpatialFrozenPhase::Workspace::Search SpatialFrozenPhase::Workspace::findEvent(double &h, Watch &event, bool &found) {
  found = false;
  for (std::size_t again = 0; again <= watches.size(); ++again) {
    const auto fallen = std::find_if(watches.begin(), watches.end(), [&](const Watch &watch) {
      return value(watch, h) < 0 && !(found && watch.kind == event.kind && watch.index == event.index);
    });
    if (fallen == watches.end())
      break;
    if (found && h * largestChange <= instant * scale)
      return Search::StartsAtLimits;
    event = *fallen;
    found = true;
    const double located = locate(event, h);
    if (!(located > 0) || (!integrate(located) && !nearlyIntegrated()))
      return Search::Failed;
    h = located;
  }
  const bool isExact = !found || event.kind != Watch::Kind::Normal || std::abs(value(event, h)) <= stillSpeed;
  return isExact ? Search::Done : Search::Failed;
}

// The direction of some slip that is not about zero at either end has changed by more than 40° in the step.
bool SpatialFrozenPhase::Workspace::turnsFar() const {
  return std::any_of(watches.begin(), watches.end(), [this](const Watch &watch) {
    if (watch.kind != Watch::Kind::PairSlip || watch.level != 0)
      return false;
    const double speed = slipSpeed(watch.index, point);
    return speed > stillSpeed && value(watch, 0) < 0.77 * speed;
  });
}

// One step along a curved piece, to the first event in it. `estimate`: of the time to the next breakpoint.
bool SpatialFrozenPhase::Workspace::curve(double estimate, bool slipStops, Watch &event, bool &found) {
  for (int j = 0; j < m; ++j)
    if (isPair(j) && mode.tangent[j] == FrozenMode::Tangent::Slip && slipSpeed(j, velocity) > 10 * stillSpeed)
      mode.setDirection(j, velocity[n + j], velocity[n + j + 1]);
  listWatches();
  integratedLength = 0;
  if (!linearise())
    return false;
  // A little beyond zeros that a straight piece would have, so that they are located at once, but for those of slips.
  double h = std::min(nextLength, slipStops ? estimate : 1.05 * estimate);
  if (!std::isfinite(h))
    h = longPiece();
  for (int k = 0; !integrate(h); ++k) {
    h *= integrator.shorter();
    if (k > 60)
      return false;
  }
  nextLength = integrator.longer() * h;
  Search search = findEvent(h, event, found);
  for (int k = 0; search != Search::Done; search = findEvent(h, event, found), ++k) {
    if (search == Search::StartsAtLimits)
      return false;
    do
      h *= 0.5;
    while (++k <= 60 && !integrate(h));
    if (k > 60)
      return false;
  }
  if (found && !settleStop(event, h, found))
    return false;
  // Where a slip has turned far, it may have missed its way to zero.
  for (int k = 0; !found && turnsFar(); ++k) {
    h *= 0.7;
    if (k > 60 || !integrate(h))
      return false;
  }
  // Steps towards a slip's zero may end within its rounding.
  for (const Watch &watch : watches)
    if (!found && watch.kind == Watch::Kind::PairSlip && watch.level == 0 && slipSpeed(watch.index, point) <= stillSpeed) {
      event = watch;
      found = true;
    }
  commit(h, found ? &event : nullptr);
  if (found) {
    finishEvent(event);
    nextLength = infinity;
  }
  return true;
}

}  // namespace tf::runtime
