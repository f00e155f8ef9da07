#include "runtime/contact/frozen_phase.h"

#include "runtime/contact/breakpoint_tail.h"
#include "runtime/contact/planar_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// Sums of terms of a magnitude are zero below this part of it: they differ from zero by rounding only.
constexpr double rounding = 32 * std::numeric_limits<double>::epsilon();
constexpr double feasibility = 1e-9;
constexpr int keptBreakpoints = 1000, tailFrom = 48;
// A contraction factor that differs from 1 by less repeats without contraction.
constexpr double contraction = 1e-9;

}  // namespace

void FrozenProblem::resize(int normals, int tangents) {
  ContactRows::resize(normals, tangents);
  delassus.setZero(count(), count());
  normalVelocity.assign(normals, 0.0);
  slipVelocity.assign(tangents, 0.0);
  rate.assign(normals, 1.0);
}

struct FrozenPhase::Workspace {
  Settings settings;
  const FrozenProblem *problem = nullptr;
  PlanarFrictionSolver solver;
  PlanarFrictionMode previous;
  BreakpointTail tail;
  FrozenResult result;
  std::vector<FrozenBreakpoint> breakpoints;
  int kept = 0;
  double tau = 0;
  std::vector<double> velocity, magnitude, impulse;   // c2 and c3, what they are sums of, and total impulses
  std::vector<double> force, acceleration, turnover;  // of the piece: λ, w = D λ, Σ |D λ|
  std::vector<double> increment;                      // of a piece: velocities, impulses, τ
  std::vector<std::uint8_t> inCycle;
  bool hasPrevious = false;

  void begin(const FrozenProblem &at, int forced);
  void roundVelocities();
  void pose(int forced);
  bool findDirection(int forced);
  int nextZero(double &duration) const;
  void advance(int row, double duration);
  void record(int row, FrozenEvent event);
  [[nodiscard]] FrozenEvent classify(int row) const;
  void markCycle();
  bool sumTail();
  [[nodiscard]] bool drifts() const;
  bool skipCycles();
  void fail(FrozenStatus status);
  void follow(int forced);
};

// Velocities that are zero but for the rounding of J v: compared with the largest one, in the metric of D.
void FrozenPhase::Workspace::roundVelocities() {
  const auto metric = [this](int r) { return problem->delassus(r, r) > 0 ? std::sqrt(problem->delassus(r, r)) : 1.0; };
  double largest = 0;
  for (int r = 0; r < problem->count(); ++r)
    largest = std::max(largest, std::abs(velocity[r]) / metric(r));
  for (int r = 0; r < problem->count(); ++r)
    if (std::abs(velocity[r]) <= rounding * largest * metric(r))
      velocity[r] = 0;
}

void FrozenPhase::Workspace::begin(const FrozenProblem &at, int forced) {
  problem = &at;
  const int count = at.count();
  velocity.resize(count);
  std::copy_n(at.normalVelocity.begin(), at.normalCount, velocity.begin());
  std::copy_n(at.slipVelocity.begin(), at.tangentCount, velocity.begin() + at.normalCount);
  roundVelocities();
  if (forced >= 0)
    velocity[forced] = std::min(velocity[forced], 0.0);
  inCycle.resize(count);
  magnitude.resize(count);
  for (int r = 0; r < count; ++r)
    magnitude[r] = std::abs(velocity[r]);
  impulse.assign(count, 0.0);
  force.assign(count, 0.0);
  acceleration.assign(count, 0.0);
  turnover.assign(count, 0.0);
  increment.resize(2 * static_cast<std::size_t>(count) + 1);
  tail.reset(2 * count + 1);
  tau = 0;
  kept = 0;
  hasPrevious = false;
  result.status = FrozenStatus::Finished;
  result.rows.clear();
  result.breakpointCount = 0;
}

// The velocity of a row decides what it does; at zero, the complementarity problem does.
void FrozenPhase::Workspace::pose(int forced) {
  const int n = problem->normalCount, m = problem->tangentCount;
  PlanarFrictionProblem &p = solver.problem();
  p.resize(n, m);
  std::copy_n(problem->delassus.data(), (n + m) * (n + m), p.delassus.data());
  for (int i = 0; i < n; ++i) {
    const bool open = velocity[i] > 0;
    p.normalKind[i] = velocity[i] != 0 || i == forced ? NormalKind::Prescribed : NormalKind::Unilateral;
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
  for (int r = 0; r < count; ++r)
    if (std::abs(acceleration[r]) <= rounding * turnover[r])
      acceleration[r] = 0;
  previous = found.mode;
  for (int i = 0; i < problem->normalCount; ++i)
    if (velocity[i] < 0 || i == forced)
      previous.normal[i] = NormalState::Upper;
  hasPrevious = true;
  return true;
}

// The row whose velocity becomes zero first, of normal rows and of the slips of contacts that push; −1 if none does.
int FrozenPhase::Workspace::nextZero(double &duration) const {
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
  return first;
}

void FrozenPhase::Workspace::advance(int row, double duration) {
  const int count = problem->count();
  for (int r = 0; r < count; ++r) {
    const double before = velocity[r];
    magnitude[r] += turnover[r] * duration;
    velocity[r] += acceleration[r] * duration;
    // Zeros at the same instant differ by rounding.
    if (r == row || (before * acceleration[r] < 0 && std::abs(velocity[r]) <= rounding * magnitude[r]))
      velocity[r] = 0;
    impulse[r] += force[r] * duration;
    increment[r] = acceleration[r] * duration;
    increment[count + r] = force[r] * duration;
  }
  increment[2 * static_cast<std::size_t>(count)] = duration;
  tau += duration;
  tail.add(row, increment);
}

FrozenEvent FrozenPhase::Workspace::classify(int row) const {
  if (row < 0)
    return FrozenEvent::Start;
  if (row >= problem->normalCount)
    return acceleration[row] == 0 ? FrozenEvent::Stick : FrozenEvent::Reversal;
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
  point.row = row;
  point.velocity = velocity;
  point.impulse = impulse;
  point.force = force;
}

void FrozenPhase::Workspace::markCycle() {
  std::fill(inCycle.begin(), inCycle.end(), std::uint8_t{0});
  for (int back = 0; back < tail.period(); ++back)
    inCycle[tail.row(back)] = 1;
}

// Infinitely many pieces at once: the velocities whose zeros make the cycle end at zero. False where another velocity might reach zero
// before.
bool FrozenPhase::Workspace::sumTail() {
  const int count = problem->count();
  markCycle();
  for (int r = 0; r < count; ++r)
    if (!inCycle[r] && velocity[r] != 0 && std::abs(velocity[r]) <= tail.variation(r))
      return false;
  for (int r = 0; r < count; ++r) {
    velocity[r] = inCycle[r] ? 0.0 : velocity[r] + tail.tail(r);
    impulse[r] += tail.tail(count + r);
  }
  tau += tail.tail(2 * count);
  tail.reset(2 * count + 1);
  hasPrevious = false;
  return true;
}

// A cycle that repeats as it is ends only if it moves another velocity.
bool FrozenPhase::Workspace::drifts() const {
  for (int r = 0; r < problem->count(); ++r)
    if (std::abs(tail.cycle(r)) > 1e-9 * tail.cycleVariation(r))
      return true;
  return false;
}

// All of the equal cycles at once that pass before the velocity of another row could reach zero.
bool FrozenPhase::Workspace::skipCycles() {
  const int count = problem->count();
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
  tail.reset(2 * count + 1);
  return true;
}

void FrozenPhase::Workspace::fail(FrozenStatus status) {
  result.status = status;
  for (int i = 0; i < problem->normalCount; ++i)
    if (force[i] > 0 || velocity[i] < 0)
      result.rows.push_back(i);
}

void FrozenPhase::Workspace::follow(int forced) {
  FrozenEvent event = FrozenEvent::Start;
  int row = -1;
  while (forced >= 0 || std::any_of(velocity.begin(), velocity.begin() + problem->normalCount, [](double c) { return c < 0; })) {
    if (!findDirection(forced))
      return fail(FrozenStatus::Unsettled);
    if (forced >= 0 && !(acceleration[forced] < 0) && !(velocity[forced] < 0))
      break;
    forced = -1;
    record(row, event == FrozenEvent::Accumulation ? event : classify(row));
    double duration = 0;
    row = nextZero(duration);
    if (row < 0)
      return fail(FrozenStatus::Unbounded);
    advance(row, duration);
    event = FrozenEvent::Start;
    const int pieces = ++result.breakpointCount;
    if (pieces > settings.breakpointLimit)
      return fail(FrozenStatus::Cycle);
    if (pieces < tailFrom || !settings.sumTails || !tail.repeats())
      continue;
    bool summed = false;
    if (tail.factor() > 0 && tail.factor() < 1 - contraction) {
      summed = sumTail();
    } else if (std::abs(tail.factor() - 1) <= contraction) {
      if (!drifts())
        return fail(FrozenStatus::Cycle);
      summed = skipCycles();
    }
    if (summed)
      event = FrozenEvent::Accumulation;
  }
  std::fill(force.begin(), force.end(), 0.0);
  std::fill(acceleration.begin(), acceleration.end(), 0.0);
  record(row, event == FrozenEvent::Accumulation ? event : classify(row));
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
  return w.result;
}

std::span<const FrozenBreakpoint> FrozenPhase::breakpoints() const {
  return {work_->breakpoints.data(), static_cast<std::size_t>(work_->kept)};
}

}  // namespace tf::runtime
