#include "runtime/contact/spatial_frozen_phase.h"

#include "runtime/contact/cone_friction.h"
#include "runtime/contact/extrapolation.h"
#include "runtime/contact/frozen_mode.h"
#include "runtime/contact/planar_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Sums of terms of a magnitude are zero below this part of it: they differ from zero by rounding only.
constexpr double rounding = 32 * std::numeric_limits<double>::epsilon();
constexpr double feasibility = 1e-9;
// Accelerations of the iterative solution are zero below this part of the terms that they are sums of.
constexpr double solved = 1e-11;
// Relative to the velocities: below `still` the direction of a slip is that of its reference, and a slip that comes to rest is zero; a
// piece that leaves its straight continuation by less than `straight` is straight.
constexpr double still = 2e-11, straight = 1e-13, accuracy = 1e-13;
constexpr int keptBreakpoints = 1000, breakpointLimit = 2000;
// Of the steps over what is within `still` of zero: how many times as far as that they go, and by how often the next one may be longer.
constexpr double stepBand = 32;
constexpr int mostDoublings = 16, window = 8;
constexpr double crowd = 1e-3, longLeap = 0.1;
constexpr int leapColumns = 7;
constexpr double leapAccuracy = 1e-12;

// A quantity that is positive on the piece; the piece ends where it falls to zero.
struct Watch {
  enum class Kind : std::uint8_t { Normal, Slip, PairSlip, HeldLow, HeldHigh, Stick, StoredImpulse, StoredWork };
  Kind kind = Kind::Normal;
  int index = 0;  // normal or tangential row
  double sign = 1;
  double level = 0;  // slips that start from zero: how far below zero they may fall
};

}  // namespace

struct SpatialFrozenPhase::Workspace {
  const FrozenProblem *problem = nullptr;
  int n = 0, m = 0;
  PlanarFrictionSolver planar;
  ConeFrictionSolver cone;
  Restitution restitution;
  Extrapolation integrator;
  FrozenResult result;
  std::vector<FrozenBreakpoint> breakpoints;
  FrozenMode mode;
  int kept = 0;
  double tau = 0, scale = 0;                          // scale: largest velocity
  std::vector<double> velocity, impulse;              // c2 (less Newton's target) and c3; total impulses
  std::vector<double> force, acceleration, turnover;  // λ, w = D λ, Σ |D λ|
  std::vector<int> leaving;                           // rows whose force has just reached a limit: 1 or −1, by its side
  std::vector<Watch> watches;
  Eigen::VectorXd state, zeroState;  // P − P(begin of the step), ∫ c2 dτ
  std::vector<double> point, pointForce;
  double nextLength = 0;
  double roundingSpeed = 0;    // velocities below are within rounding of zero
  double stillSpeed = 0;       // slips below come to rest, or start
  double motionless = solved;  // accelerations are zero below this part of the terms that they are sums of
  double largestChange = 0;    // bound of |D λ|
  int windowSteps = 0, windowBreakpoints = 0, crowding = 0;
  double windowBegin = 0;

  void begin(const FrozenProblem &at, int forced);
  [[nodiscard]] bool pushes(int i) const { return velocity[i] < 0 || restitution.stored(i); }
  [[nodiscard]] bool anyPushes() const;
  [[nodiscard]] bool isPair(int j) const { return problem->partner[j] > j; }
  [[nodiscard]] bool isSecond(int j) const { return problem->partner[j] >= 0 && problem->partner[j] < j; }
  [[nodiscard]] double slipSpeed(int j, const std::vector<double> &v) const {
    return isPair(j) ? std::hypot(v[n + j], v[n + j + 1]) : std::abs(v[n + j]);
  }
  bool pose(int forced, double step, double band, ConeFrictionProblem &p);
  bool findForces(int forced, double step, double band);
  [[nodiscard]] bool anyNearZero() const;
  bool stepOver(int forced, double step, double band);
  bool settleNearZero(int forced);
  void bringToRest(const std::vector<std::uint8_t> &rests);
  void markRests(const std::vector<double> &from, double step, double band, std::vector<std::uint8_t> &rests) const;
  bool passCrowd(int forced, bool &found);
  bool leap(int forced, double length);
  void updateAcceleration();
  bool choose(int forced);
  void chooseTangent(int j);
  bool evaluate();

  double nextBreakpoint(Watch &first) const;
  [[nodiscard]] double departure(double duration) const;
  // In which velocities may change altogether.
  [[nodiscard]] double longPiece() const { return scale / std::max(*std::max_element(turnover.begin(), turnover.end()), 1e-300); }
  void advance(const Watch &event, double duration);
  void listWatches();
  [[nodiscard]] double value(const Watch &watch, double duration) const;
  double responsiveness() const;
  bool moveTo(const Eigen::VectorXd &y, Eigen::VectorXd &rate);
  bool integrate(double h);
  // The last step has missed the accuracy by little, as steps that end at an event may.
  [[nodiscard]] bool nearlyIntegrated() const { return integrator.error() <= 1e3 * accuracy * scale / responsiveness(); }
  bool findEvent(double &h, Watch &event, bool &found);
  double locate(const Watch &watch, double high);
  bool curve(double estimate, bool slipStops, Watch &event, bool &found);
  [[nodiscard]] bool turnsFar() const;
  bool settleStop(const Watch &event, double &h, bool &found);
  void commit(double h, const Watch *event);
  void finishEvent(const Watch &event);
  bool discard();
  void record(int row, FrozenEvent event);
  [[nodiscard]] FrozenEvent classify(const Watch &event) const;
  void fail(FrozenStatus status);
  void reconcile();
  void follow(int forced);
};

void SpatialFrozenPhase::Workspace::begin(const FrozenProblem &at, int forced) {
  problem = &at;
  n = at.normalCount;
  m = at.tangentCount;
  const int count = n + m;
  velocity.assign(at.normalVelocity.begin(), at.normalVelocity.end());
  velocity.insert(velocity.end(), at.slipVelocity.begin(), at.slipVelocity.end());
  scale = 0;
  for (const double v : velocity)
    scale = std::max(scale, std::abs(v));
  roundingSpeed = std::max(rounding * scale, at.resolution);
  stillSpeed = std::max(still * scale, 4 * roundingSpeed);
  for (double &v : velocity)
    if (std::abs(v) <= roundingSpeed)
      v = 0;
  largestChange = 1e-300;
  for (int r = 0; r < count; ++r) {
    double sum = 0;
    for (int c = 0; c < count; ++c)
      sum += std::abs(at.delassus(r, c)) * (c < n ? at.rate[c] : at.friction[c - n] * at.rate[at.owner[c - n]]);
    largestChange = std::max(largestChange, sum);
  }
  windowSteps = windowBreakpoints = crowding = 0;
  windowBegin = 0;
  if (forced >= 0)
    velocity[forced] = std::min(velocity[forced], 0.0);
  restitution.begin(at.restitution, at.law, at.rate, {velocity.data(), static_cast<std::size_t>(n)});
  for (int i = 0; i < n; ++i)
    velocity[i] -= restitution.target(i);
  mode.resize(at);
  for (std::vector<double> *values : {&impulse, &force, &acceleration, &turnover, &point, &pointForce})
    values->assign(count, 0.0);
  leaving.assign(count, 0);
  state.setZero(count + n);
  zeroState = state;
  tau = 0;
  kept = 0;
  nextLength = infinity;
  result.status = FrozenStatus::Finished;
  result.rows.clear();
  result.breakpointCount = 0;
}

bool SpatialFrozenPhase::Workspace::anyPushes() const {
  for (int i = 0; i < n; ++i)
    if (pushes(i))
      return true;
  return false;
}

// As the planar phase; pairs that slip lie along their slip, `mode` has the frames. Rows within `band` of zero are decided by where a step
// of this length takes them, w = v/step + D λ. True: some slip of two components is decided.
bool SpatialFrozenPhase::Workspace::pose(int forced, double step, double band, ConeFrictionProblem &p) {
  p.resize(n, m);
  bool disks = false;
  for (int i = 0; i < n; ++i) {
    const bool decided = std::abs(velocity[i]) > band || i == forced || restitution.stored(i);
    const bool open = decided && velocity[i] > 0 && !restitution.stored(i);
    p.normalKind[i] = decided ? NormalKind::Prescribed : NormalKind::Unilateral;
    p.upper[i] = open ? 0.0 : problem->rate[i];
    if (!decided && velocity[i] != 0)
      p.bias[i] = velocity[i] / step;
  }
  for (int j = 0; j < m; ++j) {
    const int owner = problem->owner[j];
    p.owner[j] = owner;
    p.friction[j] = problem->friction[j];
    if (isPair(j))
      mode.setDirection(j, velocity[n + j], velocity[n + j + 1]);
    const bool loaded = problem->friction[j] > 0 && p.upper[owner] > 0;
    const double slip = isSecond(j) ? slipSpeed(j - 1, velocity) : isPair(j) ? slipSpeed(j, velocity) : velocity[n + j];
    const bool decided = std::abs(slip) > band;
    p.sign[j] = static_cast<std::int8_t>(!decided ? 0 : slip > 0 ? 1 : -1);
    if (!loaded || (isSecond(j) && decided))
      continue;
    p.tangentKind[j] = decided ? TangentKind::Slip : TangentKind::TwoSided;
    if (decided)
      continue;
    if (!isSecond(j) && slip != 0)
      p.bias[n + j] = slip / step;
    if (problem->partner[j] >= 0) {
      p.partner[j] = problem->partner[j];
      disks = true;
    }
  }
  mode.turn(*problem, p.delassus);
  return disks;
}

bool SpatialFrozenPhase::Workspace::findForces(int forced, double step, double band) {
  ConeFrictionProblem &p = cone.problem();
  // A step's velocities need not be better than rounding, which redundant rows do not agree within.
  const double tolerance = band > 0 ? std::max(feasibility, 10 * roundingSpeed / band) : feasibility;
  if (pose(forced, step, band, p)) {
    const ConeFrictionSolution &found = cone.solve(nullptr, tolerance);
    if (!found.solved)
      return false;
    force = found.force;
    motionless = std::max(solved, 10 * found.violation);
  } else {
    planar.problem() = p;
    const PlanarFrictionSolution &found = planar.solve(nullptr, tolerance);
    if (found.status == PlanarFrictionSolution::Status::None || found.status == PlanarFrictionSolution::Status::Unsettled)
      return false;
    force = found.force;
    motionless = solved;
  }
  mode.turnBack(*problem, force);
  return true;
}

bool SpatialFrozenPhase::Workspace::anyNearZero() const {
  for (int i = 0; i < n; ++i)
    if (velocity[i] != 0 && std::abs(velocity[i]) <= roundingSpeed && !restitution.stored(i))
      return true;
  for (int j = 0; j < m; ++j) {
    if (isSecond(j) || problem->friction[j] == 0 || (velocity[problem->owner[j]] > roundingSpeed && !restitution.stored(problem->owner[j])))
      continue;
    const double speed = slipSpeed(j, velocity);
    if (speed != 0 && speed <= (isPair(j) ? stillSpeed : roundingSpeed))
      return true;
  }
  return false;
}

// A step of the implicit Euler method: contacts that reach zero within it stay there if forces hold them.
bool SpatialFrozenPhase::Workspace::stepOver(int forced, double step, double band) {
  if (!findForces(forced, step, band))
    return false;
  updateAcceleration();
  const std::vector<double> from = velocity;
  for (int r = 0; r < n + m; ++r) {
    velocity[r] += acceleration[r] * step;
    impulse[r] += force[r] * step;
  }
  std::vector<std::uint8_t> rests;
  markRests(from, step, band, rests);
  bringToRest(rests);
  for (int i = 0; i < n; ++i)
    restitution.advance(i, from[i], (velocity[i] - from[i]) / step, step, false);
  tau += step;
  return true;
}

// Velocities of these rows, zero within rounding, become exactly zero by the least impulses, which move the rows that depend on them too.
void SpatialFrozenPhase::Workspace::bringToRest(const std::vector<std::uint8_t> &rests) {
  std::vector<int> rows;
  bool moving = false;
  for (int r = 0; r < n + m; ++r) {
    if (!rests[r])
      continue;
    rows.push_back(r);
    moving = moving || velocity[r] != 0;
  }
  if (!moving)
    return;
  const Eigen::MatrixXd D = problem->delassus.map()(rows, rows);
  Eigen::VectorXd rest(rows.size());
  for (std::size_t a = 0; a < rows.size(); ++a)
    rest[static_cast<Eigen::Index>(a)] = -velocity[rows[a]];
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
  factor.setThreshold(1e-10);
  const Eigen::VectorXd correction = factor.compute(D).solve(rest);
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const double change = correction[static_cast<Eigen::Index>(a)];
    impulse[rows[a]] += change;
    for (int r = 0; r < n + m; ++r)
      velocity[r] += problem->delassus(r, rows[a]) * change;
  }
  for (const int r : rows)
    velocity[r] = 0;
}

// Steps over what is nearly zero until nothing is.
bool SpatialFrozenPhase::Workspace::settleNearZero(int forced) {
  for (int k = 0; k <= mostDoublings && anyNearZero(); ++k) {
    const double band = stepBand * stillSpeed * std::ldexp(1.0, k);
    if (!stepOver(forced, band / largestChange, band) && k == mostDoublings)
      return false;
  }
  return true;
}

// Where steps follow each other within no time to speak of, leaps over as many of them as possible; where breakpoints do, steps over all
// that may happen, each time further.
bool SpatialFrozenPhase::Workspace::passCrowd(int forced, bool &found) {
  windowBreakpoints += found ? 1 : 0;
  if (++windowSteps < window)
    return true;
  const bool breakpointsOnly = windowBreakpoints == windowSteps;
  double length = tau - windowBegin;
  windowSteps = windowBreakpoints = 0;
  windowBegin = tau;
  if (length > crowd * scale / largestChange) {
    crowding = 0;
    return true;
  }
  const double farthest = longLeap * scale / largestChange;
  for (; length > 0 && length <= farthest && anyPushes() && leap(forced, length); length *= 2) {
    found = true;
    nextLength = infinity;
  }
  if (tau > windowBegin || !breakpointsOnly)
    return true;
  if (++crowding > mostDoublings)
    return false;
  const double band = stepBand * stillSpeed * std::ldexp(1.0, crowding);
  nextLength = infinity;
  return stepOver(forced, band / largestChange, band);
}

// Over the length by extrapolation of the implicit Euler method, for slips so slow that friction is stiff and their way is smooth all the
// same, as where a force has just left its limit. False, and nothing has changed, where that does not converge.
bool SpatialFrozenPhase::Workspace::leap(int forced, double length) {
  const int count = n + m;
  const std::vector<double> from = velocity;
  const Eigen::Map<const Eigen::VectorXd> start(from.data(), count);
  const double band = stepBand * length * largestChange;
  std::array<Eigen::VectorXd, leapColumns> table;
  Eigen::VectorXd carried, previous;
  std::vector<std::uint8_t> rests;
  bool converged = false;
  for (int k = 0; k < leapColumns && !converged; ++k) {
    velocity = from;
    carried.setZero(count);
    const double part = length / (k + 1);
    for (int step = 0; step <= k; ++step) {
      if (!findForces(forced, part, band)) {
        velocity = from;
        return false;
      }
      updateAcceleration();
      for (int r = 0; r < count; ++r) {
        velocity[r] += part * acceleration[r];
        carried[r] += part * force[r];
      }
      markRests(from, part, band, rests);
    }
    for (int j = 0; j < k; ++j) {
      const double ratio = static_cast<double>(k + 1) / (k - j);
      previous = table[static_cast<std::size_t>(j)];
      table[static_cast<std::size_t>(j)] = carried;
      carried += (carried - previous) / (ratio - 1);
    }
    if (k > 1)
      converged =
          (problem->delassus.map() * (carried - table[static_cast<std::size_t>(k - 1)])).lpNorm<Eigen::Infinity>() <= leapAccuracy * scale;
    table[static_cast<std::size_t>(k)] = carried;
  }
  const Eigen::VectorXd end = start + problem->delassus.map() * carried;
  for (int i = 0; i < n; ++i)
    converged =
        converged && (from[i] == 0 || from[i] * end[i] > 0) && restitution.exhaustion(i, from[i], (end[i] - from[i]) / length) > length;
  velocity = from;
  if (!converged)
    return false;
  for (int r = 0; r < count; ++r) {
    velocity[r] = end[r];
    impulse[r] += carried[r];
  }
  bringToRest(rests);
  for (int i = 0; i < n; ++i)
    restitution.advance(i, from[i], (velocity[i] - from[i]) / length, length, false);
  tau += length;
  return true;
}

// Rows within the band whose velocity a step of the implicit Euler method has brought to zero, or kept there.
void SpatialFrozenPhase::Workspace::markRests(const std::vector<double> &from, double step, double band,
                                              std::vector<std::uint8_t> &rests) const {
  rests.assign(n + m, 0);
  const auto isZero = [&](double speed, double before, double terms) {
    return before <= band && speed <= std::max(roundingSpeed, 100 * feasibility * (before + terms * step));
  };
  for (int i = 0; i < n; ++i)
    rests[i] = isZero(std::abs(velocity[i]), std::abs(from[i]), turnover[i]);
  for (int j = 0; j < m; ++j) {
    if (isSecond(j))
      continue;
    const int last = n + (isPair(j) ? j + 1 : j);
    rests[n + j] = rests[last] = isZero(slipSpeed(j, velocity), slipSpeed(j, from), std::max(turnover[n + j], turnover[last]));
  }
}

void SpatialFrozenPhase::Workspace::updateAcceleration() {
  std::fill(acceleration.begin(), acceleration.end(), 0.0);
  std::fill(turnover.begin(), turnover.end(), 0.0);
  for (int c = 0; c < n + m; ++c) {
    if (force[c] == 0)
      continue;
    for (int r = 0; r < n + m; ++r) {
      acceleration[r] += problem->delassus(r, c) * force[c];
      turnover[r] += std::abs(problem->delassus(r, c) * force[c]);
    }
  }
  for (int r = 0; r < n + m; ++r)
    if (std::abs(acceleration[r]) <= rounding * turnover[r])
      acceleration[r] = 0;
}

// What a slip does on the next piece.
void SpatialFrozenPhase::Workspace::chooseTangent(int j) {
  const int row = n + j, owner = problem->owner[j];
  if (mode.normal[owner] == FrozenMode::Normal::Off || problem->friction[j] == 0) {
    mode.setTangent(*problem, j, FrozenMode::Tangent::None, 0);
    return;
  }
  const bool pair = isPair(j);
  if (slipSpeed(j, velocity) > 0) {
    mode.setTangent(*problem, j, FrozenMode::Tangent::Slip, pair || velocity[row] > 0 ? 1 : -1);
    return;
  }
  const double length = pair ? std::hypot(acceleration[row], acceleration[row + 1]) : std::abs(acceleration[row]);
  const double terms = pair ? std::max(turnover[row], turnover[row + 1]) : turnover[row];
  if (length <= motionless * terms && leaving[row] == 0) {
    mode.setTangent(*problem, j, FrozenMode::Tangent::Stick, 0);
    return;
  }
  // A force that has reached its limit, at zero acceleration: the slip leaves against it.
  const bool starts = length > motionless * terms;
  const double x = starts ? acceleration[row] : -force[row];
  if (pair)
    mode.setDirection(j, x, starts ? acceleration[row + 1] : -force[row + 1]);
  mode.setTangent(*problem, j, FrozenMode::Tangent::Slip, pair || x > 0 ? 1 : -1);
}

// Forces and the mode of the next piece; false where no successor exists.
bool SpatialFrozenPhase::Workspace::choose(int forced) {
  if (!findForces(forced, 1, 0))
    return false;
  updateAcceleration();
  for (int i = 0; i < n; ++i) {
    const double rate = problem->rate[i];
    const bool decided = velocity[i] != 0 || restitution.stored(i) || i == forced;
    const bool held = !decided && force[i] > solved * rate && force[i] < rate * (1 - solved);
    mode.normal[i] = held && leaving[i] == 0 ? FrozenMode::Normal::Held
                     : held                  ? (leaving[i] > 0 ? FrozenMode::Normal::Push : FrozenMode::Normal::Off)
                     : force[i] > 0.5 * rate ? FrozenMode::Normal::Push
                                             : FrozenMode::Normal::Off;
  }
  for (int j = 0; j < m; ++j)
    if (!isSecond(j))
      chooseTangent(j);
  std::fill(leaving.begin(), leaving.end(), 0);
  point = velocity;
  return evaluate();
}

// λ and w in the mode at `velocity`.
bool SpatialFrozenPhase::Workspace::evaluate() {
  if (!mode.forces(*problem, velocity, stillSpeed, force))
    return false;
  updateAcceleration();
  for (int i = 0; i < n; ++i)
    if (mode.normal[i] == FrozenMode::Normal::Held)
      acceleration[i] = 0;
  for (int j = 0; j < m; ++j)
    if (mode.tangent[j] == FrozenMode::Tangent::Stick)
      acceleration[n + j] = 0;
  return true;
}

// The first zero if the piece were straight; infinity if there is none.
double SpatialFrozenPhase::Workspace::nextBreakpoint(Watch &first) const {
  double duration = infinity;
  const auto include = [&](double time, Watch::Kind kind, int index) {
    if (time < duration) {
      duration = time;
      first = {kind, index, 1};
    }
  };
  for (int i = 0; i < n; ++i) {
    if (velocity[i] * acceleration[i] < 0)
      include(-velocity[i] / acceleration[i], Watch::Kind::Normal, i);
    const double time = restitution.exhaustion(i, velocity[i], acceleration[i]);
    const bool byImpulse = problem->law[i] == ImpactLaw::Poisson && time >= restitution.impulse(i) / problem->rate[i];
    include(time, byImpulse ? Watch::Kind::StoredImpulse : Watch::Kind::StoredWork, i);
  }
  for (int j = 0; j < m; ++j) {
    const double speed = isSecond(j) ? 0.0 : slipSpeed(j, velocity);
    if (speed == 0 || mode.tangent[j] != FrozenMode::Tangent::Slip)
      continue;
    const double first0 = velocity[n + j] * acceleration[n + j];
    const double closing = -(isPair(j) ? first0 + velocity[n + j + 1] * acceleration[n + j + 1] : first0) / speed;
    if (closing > 0)
      include(speed / closing, isPair(j) ? Watch::Kind::PairSlip : Watch::Kind::Slip, j);
  }
  return duration;
}

// How far the slips that friction acts on leave their directions in the time.
double SpatialFrozenPhase::Workspace::departure(double duration) const {
  double largest = 0;
  for (int j = 0; j < m; ++j) {
    if (!isPair(j) || mode.tangent[j] != FrozenMode::Tangent::Slip)
      continue;
    const double speed = slipSpeed(j, velocity);
    const double x = speed > 0 ? velocity[n + j] / speed : mode.direction[j];
    const double y = speed > 0 ? velocity[n + j + 1] / speed : mode.direction[j + 1];
    const double across = x * acceleration[n + j + 1] - y * acceleration[n + j];
    if (std::abs(across) > rounding * (turnover[n + j] + turnover[n + j + 1]))
      largest = std::max(largest, std::abs(across) * duration);
  }
  return largest;
}

// Along a straight piece to its end.
void SpatialFrozenPhase::Workspace::advance(const Watch &event, double duration) {
  for (int i = 0; i < n; ++i) {
    const bool exhausted = (event.kind == Watch::Kind::StoredImpulse || event.kind == Watch::Kind::StoredWork) && event.index == i;
    restitution.advance(i, velocity[i], acceleration[i], duration, exhausted);
  }
  for (int r = 0; r < n + m; ++r) {
    const double before = velocity[r];
    velocity[r] += acceleration[r] * duration;
    impulse[r] += force[r] * duration;
    if (before * acceleration[r] < 0 && std::abs(velocity[r]) <= rounding * (std::abs(before) + turnover[r] * duration))
      velocity[r] = 0;
  }
  tau += duration;
  finishEvent(event);
}

// What the event made zero is exactly zero; forces that reach a limit leave it.
void SpatialFrozenPhase::Workspace::finishEvent(const Watch &event) {
  const int row = n + event.index;
  switch (event.kind) {
  case Watch::Kind::Normal:
    velocity[event.index] = 0;
    break;
  case Watch::Kind::Slip:
    velocity[row] = 0;
    break;
  case Watch::Kind::PairSlip:
    break;  // choose() decides
  case Watch::Kind::HeldLow:
    leaving[event.index] = -1;
    break;
  case Watch::Kind::HeldHigh:
    leaving[event.index] = 1;
    break;
  case Watch::Kind::Stick:
    leaving[row] = 1;
    break;
  case Watch::Kind::StoredImpulse:
  case Watch::Kind::StoredWork:
    break;
  }
}

void SpatialFrozenPhase::Workspace::listWatches() {
  watches.clear();
  for (int i = 0; i < n; ++i) {
    if (mode.normal[i] == FrozenMode::Normal::Held) {
      watches.push_back({Watch::Kind::HeldLow, i, 1});
      watches.push_back({Watch::Kind::HeldHigh, i, 1});
    } else {
      const double v = velocity[i] != 0 ? velocity[i] : acceleration[i];
      watches.push_back({Watch::Kind::Normal, i, v >= 0 ? 1.0 : -1.0});
    }
    if (!restitution.stored(i) || velocity[i] < 0)
      continue;
    if (problem->law[i] == ImpactLaw::Poisson)
      watches.push_back({Watch::Kind::StoredImpulse, i, 1});
    if (restitution.work(i) > 0)
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
    return watch.sign * point[i];
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
bool SpatialFrozenPhase::Workspace::moveTo(const Eigen::VectorXd &y, Eigen::VectorXd &rate) {
  const int count = n + m;
  for (int r = 0; r < count; ++r) {
    point[r] = velocity[r];
    for (int c = 0; c < count; ++c)
      point[r] += problem->delassus(r, c) * y[c];
  }
  if (!mode.forces(*problem, point, stillSpeed, pointForce))
    return false;
  rate.resize(count + n);
  std::copy(pointForce.begin(), pointForce.end(), rate.data());
  std::copy_n(point.begin(), n, rate.data() + count);
  return true;
}

// From `velocity` over h, after integrator.start: `state`, `point` and `pointForce`. False: the step is too long.
bool SpatialFrozenPhase::Workspace::integrate(double h) {
  const auto rate = [this](const Eigen::VectorXd &y, Eigen::VectorXd &f) { return moveTo(y, f); };
  const bool good = integrator.step(h, accuracy * scale / responsiveness(), rate);
  state = integrator.end();
  Eigen::VectorXd ignored;
  return moveTo(state, ignored) && good;
}

// Regula falsi (Illinois) on the step's length; the value is positive for short steps and negative at `high`. 0: shorter steps fail.
double SpatialFrozenPhase::Workspace::locate(const Watch &watch, double high) {
  double low = 0, lowValue = 0, highValue = value(watch, high);
  bool known = false;  // the value at `low`
  int side = 0;
  for (int k = 0; k < 100 && high - low > 2e-16 * high; ++k) {
    double x = known ? (lowValue * high - highValue * low) / (lowValue - highValue) : 0.5 * (low + high);
    if (!(x > low && x < high))
      x = 0.5 * (low + high);
    if (!integrate(x) && !nearlyIntegrated())
      return 0;
    const double v = value(watch, x);
    if (std::abs(v) <= 1e-16 * scale)
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

// The step's end becomes the state.
void SpatialFrozenPhase::Workspace::commit(double h, const Watch *event) {
  for (int i = 0; i < n; ++i) {
    const bool exhausted =
        event != nullptr && (event->kind == Watch::Kind::StoredImpulse || event->kind == Watch::Kind::StoredWork) && event->index == i;
    // The straight piece with the same begin and the same integral of the velocity stores the same.
    const double mean = 2 * (state[n + m + i] - velocity[i] * h) / (h * h);
    restitution.advance(i, velocity[i], mean, h, exhausted);
  }
  for (int r = 0; r < n + m; ++r) {
    impulse[r] += state[r];
    const bool zero = r < n ? mode.normal[r] == FrozenMode::Normal::Held : mode.tangent[r - n] == FrozenMode::Tangent::Stick;
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

// The first event in the step h, which becomes its end. False: it cannot be located.
bool SpatialFrozenPhase::Workspace::findEvent(double &h, Watch &event, bool &found) {
  found = false;
  for (std::size_t again = 0; again <= watches.size(); ++again) {
    const auto fallen = std::find_if(watches.begin(), watches.end(), [&](const Watch &watch) {
      return value(watch, h) < 0 && !(found && watch.kind == event.kind && watch.index == event.index);
    });
    if (fallen == watches.end())
      break;
    event = *fallen;
    found = true;
    const double located = locate(event, h);
    if (!(located > 0) || (!integrate(located) && !nearlyIntegrated()))
      return false;
    h = located;
  }
  return !found || event.kind != Watch::Kind::Normal || std::abs(value(event, h)) <= stillSpeed;
}

// The direction of some slip that is not about zero at either end has changed by more than 40° in the step.
bool SpatialFrozenPhase::Workspace::turnsFar() const {
  return std::any_of(watches.begin(), watches.end(), [this](const Watch &watch) {
    const double speed = slipSpeed(watch.index, point);
    return watch.kind == Watch::Kind::PairSlip && watch.level == 0 && speed > stillSpeed && value(watch, 0) < 0.77 * speed;
  });
}

// One step along a curved piece, to the first event in it. `estimate`: of the time to the next breakpoint.
bool SpatialFrozenPhase::Workspace::curve(double estimate, bool slipStops, Watch &event, bool &found) {
  for (int j = 0; j < m; ++j)
    if (isPair(j) && mode.tangent[j] == FrozenMode::Tangent::Slip && slipSpeed(j, velocity) > 10 * stillSpeed)
      mode.setDirection(j, velocity[n + j], velocity[n + j + 1]);
  listWatches();
  const auto rate = [this](const Eigen::VectorXd &y, Eigen::VectorXd &f) { return moveTo(y, f); };
  if (!integrator.start(zeroState, 0.1 * stillSpeed / responsiveness(), rate))
    return false;
  // A little beyond zeros that a straight piece would have, so that they are located at once, but for those of slips.
  double h = std::min(nextLength, slipStops ? estimate : 1.05 * estimate);
  if (!std::isfinite(h))
    h = longPiece();
  for (int k = 0; !integrate(h); ++k) {
    h *= 0.5;
    if (k > 60)
      return false;
  }
  nextLength = integrator.used() <= 6 ? 2 * h : h;
  for (int k = 0; !findEvent(h, event, found); ++k) {
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

// Nothing moves: contacts that push only because of what they have stored push in vain. False if there are none.
bool SpatialFrozenPhase::Workspace::discard() {
  bool any = false;
  for (int i = 0; i < n; ++i) {
    const bool aims = restitution.target(i) > 0 && force[i] > 0 && velocity[i] + restitution.target(i) >= 0;
    if (!aims && !(restitution.stored(i) && velocity[i] >= 0))
      continue;
    velocity[i] += restitution.discard(i);
    any = true;
  }
  return any;
}

FrozenEvent SpatialFrozenPhase::Workspace::classify(const Watch &event) const {
  const int i = event.index;
  switch (event.kind) {
  case Watch::Kind::Slip:
  case Watch::Kind::PairSlip:
    return mode.tangent[i] == FrozenMode::Tangent::Slip ? FrozenEvent::Reversal : FrozenEvent::Stick;
  case Watch::Kind::Stick:
    return FrozenEvent::Reversal;
  case Watch::Kind::Normal:
    if (restitution.stored(i))
      return acceleration[i] < 0 ? FrozenEvent::Recompression : FrozenEvent::Restitution;
    return mode.normal[i] == FrozenMode::Normal::Off    ? FrozenEvent::Separation
           : mode.normal[i] == FrozenMode::Normal::Held ? FrozenEvent::Held
                                                        : FrozenEvent::Recompression;
  case Watch::Kind::HeldHigh:
    return FrozenEvent::Recompression;
  case Watch::Kind::HeldLow:
  case Watch::Kind::StoredImpulse:
  case Watch::Kind::StoredWork:
    return FrozenEvent::Separation;
  }
  return FrozenEvent::Start;
}

void SpatialFrozenPhase::Workspace::record(int row, FrozenEvent event) {
  if (kept >= keptBreakpoints)
    return;
  if (static_cast<int>(breakpoints.size()) == kept)
    breakpoints.emplace_back();
  FrozenBreakpoint &at = breakpoints[kept++];
  at.tau = tau;
  at.event = event;
  at.row = row;
  at.velocity = velocity;
  for (int i = 0; i < n; ++i)
    at.velocity[i] += restitution.target(i);
  at.impulse = impulse;
  at.force = force;
}

void SpatialFrozenPhase::Workspace::fail(FrozenStatus status) {
  result.status = status;
  for (int i = 0; i < n; ++i)
    if (force[i] > 0 || pushes(i))
      result.rows.push_back(i);
}

// Slips that came to rest were set to zero from a rest within rounding: the impulses take it too, so that v = v⁻ + D P on all rows at zero.
void SpatialFrozenPhase::Workspace::reconcile() {
  std::vector<int> rows;
  for (int r = 0; r < n + m; ++r)
    if (velocity[r] == 0 && impulse[r] != 0)
      rows.push_back(r);
  const int count = static_cast<int>(rows.size());
  Eigen::MatrixXd D(count, count);
  Eigen::VectorXd rest(count);
  for (int a = 0; a < count; ++a) {
    const int r = rows[a];
    rest[a] = r < n ? restitution.target(r) - problem->normalVelocity[r] : -problem->slipVelocity[r - n];
    for (int c = 0; c < n + m; ++c)
      rest[a] -= problem->delassus(r, c) * impulse[c];
    for (int b = 0; b < count; ++b)
      D(a, b) = problem->delassus(r, rows[b]);
  }
  if (count == 0)
    return;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
  factor.setThreshold(1e-10);
  const Eigen::VectorXd correction = factor.compute(D).solve(rest);
  if (correction.lpNorm<Eigen::Infinity>() * responsiveness() <= 1e3 * stillSpeed)
    for (int a = 0; a < count; ++a)
      impulse[rows[a]] += correction[a];
}

void SpatialFrozenPhase::Workspace::follow(int forced) {
  Watch event;
  FrozenEvent label = FrozenEvent::Start;
  bool found = true;  // a breakpoint: the mode is chosen anew
  int escapes = 0;
  for (;;) {
    if (anyNearZero()) {
      if (!settleNearZero(forced))
        return fail(FrozenStatus::Unsettled);
      found = true;
    }
    if (!passCrowd(forced, found))
      return fail(FrozenStatus::Cycle);
    if (forced < 0 && !anyPushes())
      break;
    if (found ? !choose(forced) : !evaluate())
      return fail(FrozenStatus::Unsettled);
    if (restitution.push(force)) {
      found = true;
      continue;
    }
    if (forced >= 0 && !(acceleration[forced] < 0) && !(velocity[forced] < 0))
      break;
    forced = -1;
    const int row = event.kind == Watch::Kind::Slip || event.kind == Watch::Kind::PairSlip || event.kind == Watch::Kind::Stick
                        ? n + event.index
                        : event.index;
    record(tau == 0 || !found ? -1 : row, tau == 0                        ? FrozenEvent::Start
                                          : !found                        ? FrozenEvent::Turn
                                          : label == FrozenEvent::Discard ? label
                                                                          : classify(event));
    Watch next;
    const double duration = nextBreakpoint(next);
    label = FrozenEvent::Start;
    const bool turns = departure(std::isfinite(duration) ? duration : longPiece()) > straight * scale;
    if (!turns && !std::isfinite(duration)) {
      if (!discard())
        return fail(FrozenStatus::Unbounded);
      label = FrozenEvent::Discard;
      found = true;
      continue;
    }
    if (++result.breakpointCount > breakpointLimit)
      return fail(FrozenStatus::Cycle);
    if (turns) {
      if (curve(duration, next.kind == Watch::Kind::PairSlip, event, found)) {
        escapes = 0;
        continue;
      }
      const double band = stepBand * stillSpeed * std::ldexp(1.0, ++escapes);
      if (escapes > mostDoublings || !stepOver(forced, band / largestChange, band))
        return fail(FrozenStatus::Unsettled);
      found = true;
      nextLength = infinity;
      continue;
    }
    event = next;
    advance(event, duration);
    found = true;
    nextLength = infinity;
  }
  std::fill(force.begin(), force.end(), 0.0);
  record(tau == 0 ? -1 : event.index, tau == 0 ? FrozenEvent::Start : FrozenEvent::Separation);
}

SpatialFrozenPhase::SpatialFrozenPhase() : work_(std::make_unique<Workspace>()) {}
SpatialFrozenPhase::~SpatialFrozenPhase() = default;
SpatialFrozenPhase::SpatialFrozenPhase(SpatialFrozenPhase &&) noexcept = default;
SpatialFrozenPhase &SpatialFrozenPhase::operator=(SpatialFrozenPhase &&) noexcept = default;

const FrozenResult &SpatialFrozenPhase::run(const FrozenProblem &problem, int forced) {
  Workspace &w = *work_;
  w.begin(problem, forced);
  w.follow(forced);
  if (w.result.status == FrozenStatus::Finished)
    w.reconcile();
  w.result.duration = w.tau;
  w.result.impulse = w.impulse;
  w.result.velocity = w.velocity;
  for (int i = 0; i < problem.normalCount; ++i)
    w.result.velocity[i] += w.restitution.target(i);
  return w.result;
}

std::span<const FrozenBreakpoint> SpatialFrozenPhase::breakpoints() const {
  return {work_->breakpoints.data(), static_cast<std::size_t>(work_->kept)};
}

}  // namespace tf::runtime
