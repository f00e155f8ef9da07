#include "runtime/contact/frozen_phase.h"

#include "runtime/contact/breakpoint_tail.h"
#include "runtime/contact/numbers.h"
#include "runtime/contact/planar_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

constexpr double feasibility = 1e-9;
// D_s below this part of what it is the difference of is zero for a frictional impulse.
constexpr double jammedAcceleration = 1e-6;
constexpr int keptBreakpoints = 1000, tailFrom = 24;
// A contraction factor that differs from 1 by less repeats without contraction.
constexpr double clearContraction = 1e-9;
// Contacts with restitution among others that press for long may chatter at any scale without a cycle that repeats. Each time that so many
// breakpoints have passed, what counts as zero grows, up to a limit far below the accuracy of any run.
constexpr int coarsenEvery = 2048;
constexpr double coarsening = 10, coarsest = 1e-9;
// Contacts that no impulse can part may approach by this part of the fastest velocity, or by so many rounding errors of velocities.
constexpr double unresolved = 1e-6, roundings = 1e4;

}  // namespace

void FrozenProblem::resize(int normals, int tangents) {
  ContactRows::resize(normals, tangents);
  delassus.setZero(count(), count());
  normalVelocity.assign(normals, 0.0);
  slipVelocity.assign(tangents, 0.0);
  rate.assign(normals, 1.0);
  restitution.assign(normals, 0.0);
  law.assign(normals, ImpactLaw::Poisson);
}

struct FrozenPhase::Workspace {
  Settings settings;
  const FrozenProblem *problem = nullptr;
  PlanarFrictionSolver solver;
  PlanarFrictionMode previous;
  Restitution restitution;
  BreakpointTail tail;
  FrozenResult result;
  std::vector<FrozenBreakpoint> breakpoints;
  int kept = 0;
  double tau = 0;
  std::vector<double> velocity, magnitude, impulse;   // c2 (less Newton's target) and c3, what they are sums of, and total impulses
  std::vector<double> force, acceleration, turnover;  // of the piece: λ, w = D λ, Σ |D λ|
  std::vector<double> increment;                      // of a piece: velocities, impulses, τ, stored impulses, stored works
  double zero = roundingOfSums;                       // velocities below this part of the fastest are zero
  double fastest = 0;                                 // the largest velocity and change of velocity, in the metric of D
  std::vector<double> metric;                         // √D_rr
  std::vector<std::uint8_t> inCycle;                  // rows, then what normal rows store
  bool hasPrevious = false;

  void begin(const FrozenProblem &at, int forced);
  void measureVelocities();
  void roundVelocities();
  void coarsen();
  [[nodiscard]] bool pushes(int normal) const { return velocity[normal] < 0 || restitution.stored(normal); }
  [[nodiscard]] bool anyPushes() const;
  void resetTail();
  void pose(int forced);
  void settleAccelerations();
  bool findDirection(int forced);
  int nextBreakpoint(double &duration) const;
  bool giveUp(bool ends);
  bool stopApproaches();
  void advance(int row, double duration);
  void advanceStores(int row, double duration);
  void record(int row, FrozenEvent event);
  [[nodiscard]] FrozenEvent classify(int row) const;
  void markCycle();
  bool sumTail();
  [[nodiscard]] double workTail(int i, double limit) const;
  [[nodiscard]] bool drifts() const;
  bool skipCycles();
  void fail(FrozenStatus status);
  bool jams(int forced);
  void follow(int forced);
};

void FrozenPhase::Workspace::measureVelocities() {
  for (int r = 0; r < problem->count(); ++r)
    fastest = std::max(fastest, magnitude[r] / metric[r]);
}

// Velocities that are zero but for the rounding of J v: compared with the largest one, in the metric of D.
void FrozenPhase::Workspace::roundVelocities() {
  for (int r = 0; r < problem->count(); ++r)
    if (std::abs(velocity[r]) <= std::max(zero * fastest * metric[r], problem->resolution))
      velocity[r] = 0;
}

void FrozenPhase::Workspace::coarsen() {
  zero = std::max(zero, problem->resolution / fastest);
  zero = std::max(zero, std::min(coarsening * zero, coarsest));
}

void FrozenPhase::Workspace::begin(const FrozenProblem &at, int forced) {
  problem = &at;
  const int count = at.count();
  velocity.resize(count);
  std::copy_n(at.normalVelocity.begin(), at.normalCount, velocity.begin());
  std::copy_n(at.slipVelocity.begin(), at.tangentCount, velocity.begin() + at.normalCount);
  metric.resize(count);
  for (int r = 0; r < count; ++r)
    metric[r] = at.delassus(r, r) > 0 ? std::sqrt(at.delassus(r, r)) : 1.0;
  zero = roundingOfSums;
  fastest = 0;
  magnitude.resize(count);
  for (int r = 0; r < count; ++r)
    magnitude[r] = std::abs(velocity[r]);
  measureVelocities();
  roundVelocities();
  if (forced >= 0)
    velocity[forced] = std::min(velocity[forced], 0.0);
  for (int r = 0; r < count; ++r)
    magnitude[r] = std::abs(velocity[r]);
  restitution.begin(at.restitution, at.law, at.rate, {velocity.data(), static_cast<std::size_t>(at.normalCount)});
  for (int i = 0; i < at.normalCount; ++i)
    velocity[i] -= restitution.target(i);
  impulse.assign(count, 0.0);
  force.assign(count, 0.0);
  acceleration.assign(count, 0.0);
  turnover.assign(count, 0.0);
  inCycle.resize(static_cast<std::size_t>(count) + at.normalCount);
  increment.resize(2 * static_cast<std::size_t>(count) + 1 + 2 * static_cast<std::size_t>(at.normalCount));
  resetTail();
  tau = 0;
  kept = 0;
  hasPrevious = false;
  result.status = FrozenStatus::Finished;
  result.leavesApproach = false;
  result.rows.clear();
  result.breakpointCount = 0;
}

void FrozenPhase::Workspace::resetTail() {
  const int compared = 2 * problem->count() + 1 + problem->normalCount;
  tail.reset(compared + problem->normalCount, compared);
}

bool FrozenPhase::Workspace::anyPushes() const {
  for (int i = 0; i < problem->normalCount; ++i)
    if (pushes(i))
      return true;
  return false;
}

// The velocity of a row and what it has stored decide what it does; at zero, with nothing stored, the complementarity problem does.
void FrozenPhase::Workspace::pose(int forced) {
  const int n = problem->normalCount, m = problem->tangentCount;
  PlanarFrictionProblem &p = solver.problem();
  p.resize(n, m);
  std::copy_n(problem->delassus.data(), (n + m) * (n + m), p.delassus.data());
  for (int i = 0; i < n; ++i) {
    const bool open = velocity[i] > 0 && !restitution.stored(i);
    p.normalKind[i] = velocity[i] != 0 || i == forced || restitution.stored(i) ? NormalKind::Prescribed : NormalKind::Unilateral;
    p.upper[i] = open ? 0.0 : problem->rate[i];
  }
  for (int j = 0; j < m; ++j) {
    const int owner = problem->owner[j];
    const double slip = velocity[n + j];
    p.owner[j] = owner;
    p.friction[j] = owner >= 0 ? problem->friction[j] : 0.0;
    p.sign[j] = static_cast<std::int8_t>(slip > 0 ? 1 : slip < 0 ? -1 : 0);
    if (owner >= 0 && problem->friction[j] > 0 && p.upper[owner] > 0)
      p.tangentKind[j] = slip != 0 ? TangentKind::Slip : TangentKind::TwoSided;
  }
}

// What is zero but for rounding. Rows at rest stay where their force is within its limits, and leave to the side that it cannot hold them
// from: a condition that is violated within the solver's tolerance is no motion.
void FrozenPhase::Workspace::settleAccelerations() {
  const PlanarFrictionProblem &p = solver.problem();
  const PlanarFrictionSolution &found = solver.solution();
  for (int r = 0; r < problem->count(); ++r)
    if (std::abs(acceleration[r]) <= roundingOfSums * turnover[r])
      acceleration[r] = 0;
  for (int i = 0; i < p.normalCount; ++i) {
    if (p.normalKind[i] != NormalKind::Unilateral)
      continue;
    if (found.mode.normal[i] == NormalState::Off)
      acceleration[i] = std::max(acceleration[i], 0.0);
    else if (found.mode.normal[i] == NormalState::Upper)
      acceleration[i] = std::min(acceleration[i], 0.0);
    else
      acceleration[i] = 0;
  }
}

// λ and w of the next piece; false where no successor exists.
bool FrozenPhase::Workspace::findDirection(int forced) {
  pose(forced);
  const PlanarFrictionSolution &found = solver.solve(hasPrevious ? &previous : nullptr, feasibility);
  if (found.status == PlanarFrictionSolution::Status::None || found.status == PlanarFrictionSolution::Status::Unsettled)
    return false;
  const int count = problem->count();
  force = found.force;
  acceleration = found.acceleration;
  std::fill(turnover.begin(), turnover.end(), 0.0);
  for (int c = 0; c < count; ++c)
    if (force[c] != 0)
      for (int r = 0; r < count; ++r)
        turnover[r] += std::abs(problem->delassus(r, c) * force[c]);
  settleAccelerations();
  previous = found.mode;
  for (int i = 0; i < problem->normalCount; ++i)
    if (pushes(i) || i == forced)
      previous.normal[i] = NormalState::Upper;
  hasPrevious = true;
  return true;
}

// What becomes zero first: the velocity of a normal row or the slip of a contact that pushes, or (count + i) what contact i has stored; −1
// if nothing does.
int FrozenPhase::Workspace::nextBreakpoint(double &duration) const {
  const int n = problem->normalCount;
  int first = -1;
  for (int r = 0; r < problem->count(); ++r) {
    if (velocity[r] == 0 || velocity[r] * acceleration[r] >= 0)
      continue;
    const int owner = r < n ? r : problem->owner[r - n];
    if (r >= n && (owner < 0 || !(force[owner] > 0) || problem->friction[r - n] == 0))
      continue;
    const double time = -velocity[r] / acceleration[r];
    if (first < 0 || time < duration) {
      first = r;
      duration = time;
    }
  }
  for (int i = 0; i < n; ++i) {
    const double time = restitution.exhaustion(i, velocity[i], acceleration[i]);
    if (std::isfinite(time) && (first < 0 || time < duration)) {
      first = problem->count() + i;
      duration = time;
    }
  }
  return first;
}

bool FrozenPhase::Workspace::giveUp(bool ends) {
  const bool any = restitution.giveUp(velocity, force, [this](int i) { return roundingOfSums * magnitude[i]; }, ends);
  resetTail();
  return any;
}

// Nothing moves, but contacts that no impulse can part, as those of bodies that just fit between two walls, approach by what is left of
// velocities that are larger by orders of magnitude. False: faster, or none do.
bool FrozenPhase::Workspace::stopApproaches() {
  bool any = false;
  for (int i = 0; i < problem->normalCount; ++i) {
    if (velocity[i] < -std::max(unresolved * fastest * metric[i], roundings * problem->resolution))
      return false;
    any = any || velocity[i] < 0;
  }
  for (int i = 0; i < problem->normalCount && any; ++i)
    velocity[i] = std::max(velocity[i], 0.0);
  result.leavesApproach = result.leavesApproach || any;
  return any;
}

void FrozenPhase::Workspace::advanceStores(int row, double duration) {
  const int n = problem->normalCount, count = problem->count();
  for (int i = 0; i < n; ++i) {
    const double impulseBefore = restitution.impulse(i), workBefore = restitution.work(i);
    restitution.advance(i, velocity[i], acceleration[i], duration, row == count + i);
    increment[2 * static_cast<std::size_t>(count) + 1 + i] = restitution.impulse(i) - impulseBefore;
    increment[2 * static_cast<std::size_t>(count) + 1 + n + i] = restitution.work(i) - workBefore;
  }
}

void FrozenPhase::Workspace::advance(int row, double duration) {
  const int count = problem->count();
  advanceStores(row, duration);
  for (int r = 0; r < count; ++r) {
    const double before = velocity[r];
    magnitude[r] += turnover[r] * duration;
    velocity[r] += acceleration[r] * duration;
    // Zeros at the same instant differ by rounding.
    if (r == row || (before * acceleration[r] < 0 && std::abs(velocity[r]) <= roundingOfSums * magnitude[r]))
      velocity[r] = 0;
    impulse[r] += force[r] * duration;
    increment[r] = acceleration[r] * duration;
    increment[count + r] = force[r] * duration;
  }
  measureVelocities();
  roundVelocities();
  increment[2 * static_cast<std::size_t>(count)] = duration;
  tau += duration;
  tail.add(row, increment);
}

FrozenEvent FrozenPhase::Workspace::classify(int row) const {
  if (row < 0)
    return FrozenEvent::Start;
  if (row >= problem->count())
    row -= problem->count();
  if (row >= problem->normalCount)
    return acceleration[row] == 0 ? FrozenEvent::Stick : FrozenEvent::Reversal;
  if (restitution.stored(row))
    return acceleration[row] < 0 ? FrozenEvent::Recompression : FrozenEvent::Restitution;
  if (!(force[row] > 0))
    return FrozenEvent::Separation;
  return force[row] < problem->rate[row] ? FrozenEvent::Held : FrozenEvent::Recompression;
}

// The state before the next piece, at the zero of `row`.
void FrozenPhase::Workspace::record(int row, FrozenEvent event) {
  if (kept >= keptBreakpoints)
    return;
  if (static_cast<int>(breakpoints.size()) == kept)
    breakpoints.emplace_back();
  FrozenBreakpoint &point = breakpoints[kept++];
  point.tau = tau;
  point.event = event;
  point.row = row >= problem->count() ? row - problem->count() : row;
  point.velocity = velocity;
  for (int i = 0; i < problem->normalCount; ++i)
    point.velocity[i] += restitution.target(i);
  point.impulse = impulse;
  point.force = force;
}

void FrozenPhase::Workspace::markCycle() {
  std::fill(inCycle.begin(), inCycle.end(), std::uint8_t{0});
  for (int back = 0; back < tail.period(); ++back)
    inCycle[tail.row(back)] = 1;
}

// Work that contact i stores in the pieces to come; its velocity converges to `limit`. The part of the limit velocity shrinks
// by the factor of the cycle, the rest, quadratic in what shrinks, by its square.
double FrozenPhase::Workspace::workTail(int i, double limit) const {
  const int count = problem->count();
  const double factor = tail.factor();
  const double share = problem->law[i] == ImpactLaw::Stronge && limit < 0 ? problem->restitution[i] * problem->restitution[i] : 1;
  const double linear = -share * limit * tail.cycle(count + i);
  const double quadratic = tail.cycle(2 * count + 1 + problem->normalCount + i) - linear;
  return linear * factor / (1 - factor) + quadratic * factor * factor / (1 - factor * factor);
}

// Infinitely many pieces at once: what becomes zero in the cycle ends at zero. False where something else might reach zero before.
bool FrozenPhase::Workspace::sumTail() {
  const int n = problem->normalCount, count = problem->count();
  markCycle();
  for (int r = 0; r < count; ++r)
    if (!inCycle[r] && velocity[r] != 0 && std::abs(velocity[r]) <= tail.variation(r))
      return false;
  const auto limit = [&](int r) { return inCycle[r] ? 0.0 : velocity[r] + tail.tail(r); };
  for (int i = 0; i < n; ++i) {
    if (inCycle[count + i] || !restitution.stored(i))
      continue;
    if (problem->law[i] == ImpactLaw::Poisson && restitution.impulse(i) <= tail.variation(2 * count + 1 + i))
      return false;
    if (restitution.work(i) > 0 && restitution.work(i) <= 2 * std::abs(workTail(i, limit(i))))
      return false;
  }
  for (int i = 0; i < n; ++i)
    if (restitution.storesWork(i) && !inCycle[count + i])
      restitution.set(i, restitution.impulse(i) + tail.tail(2 * count + 1 + i), restitution.work(i) + workTail(i, limit(i)));
  for (int r = 0; r < count; ++r) {
    velocity[r] = limit(r);
    impulse[r] += tail.tail(count + r);
  }
  tau += tail.tail(2 * count);
  resetTail();
  hasPrevious = false;
  return true;
}

// A cycle that repeats as it is ends only if it moves another velocity.
bool FrozenPhase::Workspace::drifts() const {
  const int count = problem->count();
  for (int r = 0; r < count; ++r)
    if (std::abs(tail.cycle(r)) > 1e-9 * tail.cycleVariation(r))
      return true;
  for (int k = 2 * count + 1; k < 2 * count + 1 + problem->normalCount; ++k)
    if (std::abs(tail.cycle(k)) > 1e-9 * tail.cycleVariation(k))
      return true;
  return false;
}

// All of the equal cycles at once that pass before the velocity of another row could reach zero. Stored works change quadratically over
// the cycles: contacts with restitution are followed one by one.
bool FrozenPhase::Workspace::skipCycles() {
  const int count = problem->count();
  for (int i = 0; i < problem->normalCount; ++i)
    if (restitution.storesWork(i))
      return false;
  markCycle();
  double cycles = std::numeric_limits<double>::infinity();
  for (int r = 0; r < count; ++r)
    if (!inCycle[r] && velocity[r] * tail.cycle(r) < 0)
      cycles = std::min(cycles, (std::abs(velocity[r]) - tail.cycleVariation(r)) / std::abs(tail.cycle(r)));
  cycles = std::floor(cycles) - 1;
  if (!(cycles >= 1) || !std::isfinite(cycles))
    return false;
  for (int r = 0; r < count; ++r) {
    if (!inCycle[r])
      velocity[r] += cycles * tail.cycle(r);
    impulse[r] += cycles * tail.cycle(count + r);
  }
  tau += cycles * tail.cycle(2 * count);
  resetTail();
  return true;
}

void FrozenPhase::Workspace::fail(FrozenStatus status) {
  result.status = status;
  for (int i = 0; i < problem->normalCount; ++i)
    if (force[i] > 0 || pushes(i))
      result.rows.push_back(i);
}

// Whether the contact that starts a frictional impulse is pressed in by it, or stays where it is, D_s = 0, until the slip ends.
bool FrozenPhase::Workspace::jams(int forced) {
  if (velocity[forced] < 0 || acceleration[forced] < 0)
    return true;
  if (acceleration[forced] > jammedAcceleration * turnover[forced])
    return false;
  acceleration[forced] = 0;
  double duration = 0;
  return nextBreakpoint(duration) >= 0;
}

void FrozenPhase::Workspace::follow(int forced) {
  FrozenEvent event = FrozenEvent::Start;
  int row = -1;
  while (forced >= 0 || anyPushes()) {
    if (!findDirection(forced))
      return fail(FrozenStatus::Unsettled);
    if (restitution.push(force))
      continue;
    if (forced >= 0 && !jams(forced))
      break;
    forced = -1;
    record(row, event == FrozenEvent::Start ? classify(row) : event);
    double duration = 0;
    row = nextBreakpoint(duration);
    event = FrozenEvent::Start;
    if ((row < 0 || standsStill(acceleration, turnover)) && giveUp(row < 0)) {
      event = FrozenEvent::Discard;
      continue;
    }
    if (row < 0 && stopApproaches())
      continue;
    if (row < 0)
      return fail(FrozenStatus::Unbounded);
    advance(row, duration);
    const int pieces = ++result.breakpointCount;
    if (pieces > settings.breakpointLimit)
      return fail(FrozenStatus::Cycle);
    if (pieces % coarsenEvery == 0)
      coarsen();
    if (pieces < tailFrom || !settings.sumTails || !tail.repeats())
      continue;
    bool summed = false;
    if (tail.factor() > 0 && tail.factor() < 1 - clearContraction) {
      summed = sumTail();
    } else if (std::abs(tail.factor() - 1) <= clearContraction) {
      if (drifts()) {
        summed = skipCycles();
      } else if (giveUp(true)) {
        event = FrozenEvent::Discard;
      } else {
        return fail(FrozenStatus::Cycle);
      }
    }
    if (summed)
      event = FrozenEvent::Accumulation;
  }
  std::fill(force.begin(), force.end(), 0.0);
  std::fill(acceleration.begin(), acceleration.end(), 0.0);
  record(row, event == FrozenEvent::Start ? classify(row) : event);
}

FrozenPhase::FrozenPhase() : FrozenPhase(Settings{}) {}
FrozenPhase::FrozenPhase(const Settings &settings) : work_(std::make_unique<Workspace>()) { work_->settings = settings; }
FrozenPhase::~FrozenPhase() = default;
FrozenPhase::FrozenPhase(FrozenPhase &&) noexcept = default;
FrozenPhase &FrozenPhase::operator=(FrozenPhase &&) noexcept = default;

const FrozenResult &FrozenPhase::run(const FrozenProblem &problem, int forced) {
  Workspace &w = *work_;
  w.begin(problem, forced);
  w.follow(forced);
  w.result.duration = w.tau;
  w.result.impulse = w.impulse;
  w.result.velocity = w.velocity;
  for (int i = 0; i < problem.normalCount; ++i)
    w.result.velocity[i] += w.restitution.target(i);
  return w.result;
}

std::span<const FrozenBreakpoint> FrozenPhase::breakpoints() const {
  return {work_->breakpoints.data(), static_cast<std::size_t>(work_->kept)};
}

}  // namespace tf::runtime
