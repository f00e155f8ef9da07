// Steps of the implicit Euler method, whose contact problem decides together which slips stop, which contacts are held and which leave:
// it has a solution always, since forces are bounded by the rates.
#include "runtime/contact/spatial_frozen_workspace.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tf::runtime {

// As the planar phase; pairs that slip lie along their slip, `mode` has the frames. Rows within `band` of zero are decided by where a step
// of this length takes them, w = v/step + D λ. True: some slip of two components is decided.
bool SpatialFrozenPhase::Workspace::pose(int forced, double step, double band, ConeFrictionProblem &p) {
  p.resize(n, m);
  bool disks = false;
  for (int i = 0; i < n; ++i) {
    const bool decided = isDecided(i, forced, band) || opened[i] != 0;
    const bool open = opened[i] != 0 || (decided && velocity[i] > 0 && !restitution.stored(i));
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

// Of several solutions the one with the previous mode counts (theory.md section 3): contacts that were open, and that nothing need hold,
// are held by no force.
bool SpatialFrozenPhase::Workspace::findForces(int forced, double step, double band) {
  opened.assign(n, 0);
  if (!solveForces(forced, step, band))
    return false;
  bool isAny = false;
  for (int i = 0; i < n; ++i) {
    opened[i] = !isDecided(i, forced, band) && mode.normal[i] == FrozenMode::Normal::Off && force[i] > solved * problem->rate[i] ? 1 : 0;
    isAny = isAny || opened[i] != 0;
  }
  if (!isAny)
    return true;
  const std::vector<double> held = force;
  const double motionlessHeld = motionless;
  if (!solveForces(forced, step, band) || !stayOpen(step)) {
    force = held;
    motionless = motionlessHeld;
  }
  return true;
}

// Whether the contacts of `opened` do not approach, with the forces of a solution without theirs.
bool SpatialFrozenPhase::Workspace::stayOpen(double step) {
  updateAcceleration();
  const double rounding = motionless * *std::max_element(turnover.begin(), turnover.end());
  for (int i = 0; i < n; ++i)
    if (opened[i] && !(velocity[i] / step + acceleration[i] >= -rounding))
      return false;
  return true;
}

bool SpatialFrozenPhase::Workspace::solveForces(int forced, double step, double band) {
  ConeFrictionProblem &p = cone.problem();
  // A step's velocities need not be better than rounding, which redundant rows do not agree within.
  const double tolerance = band > 0 ? std::max(feasibility, 10 * roundingSpeed / band) : feasibility;
  if (pose(forced, step, band, p)) {
    // One step after the other has nearly the same forces.
    guess = force;
    mode.turnForces(*problem, 1, guess);
    const bool isKnown = std::any_of(guess.begin(), guess.end(), [](double f) { return f != 0; });
    const ConeFrictionSolution &found = cone.solve(isKnown ? guess.data() : nullptr, tolerance);
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
  mode.turnForces(*problem, -1, force);
  return true;
}

bool SpatialFrozenPhase::Workspace::isNormalStill(int i) const { return std::abs(velocity[i]) <= roundingSpeed && !restitution.stored(i); }

// Of a contact that can have friction; of two components the first stands for both.
bool SpatialFrozenPhase::Workspace::isSlipStill(int j) const {
  const int owner = problem->owner[j];
  if (isSecond(j) || problem->friction[j] == 0 || (velocity[owner] > roundingSpeed && !restitution.stored(owner)))
    return false;
  return slipSpeed(j, velocity) <= (isPair(j) ? stillSpeed : roundingSpeed);
}

// Still, but not zero.
bool SpatialFrozenPhase::Workspace::anyNearZero() const {
  for (int i = 0; i < n; ++i)
    if (velocity[i] != 0 && isNormalStill(i))
      return true;
  for (int j = 0; j < m; ++j)
    if (isSlipStill(j) && slipSpeed(j, velocity) != 0)
      return true;
  return false;
}

// Forces and accelerations of a step of the implicit Euler method, which becomes shorter where a contact uses up what it has stored.
bool SpatialFrozenPhase::Workspace::poseStep(int forced, double &step, double band) {
  for (int pass = 0; pass <= n; ++pass) {
    if (!findForces(forced, step, band))
      return false;
    updateAcceleration();
    double last = step;
    for (int i = 0; i < n; ++i)
      last = std::min(last, restitution.exhaustionThroughZero(i, velocity[i], acceleration[i]));
    if (!(last < step))
      break;
    step = last;
  }
  return true;
}

// A step of the implicit Euler method: contacts that reach zero within it stay there if forces hold them.
bool SpatialFrozenPhase::Workspace::stepOver(int forced, double step, double band) {
  if (!poseStep(forced, step, band))
    return false;
  const std::vector<double> from = velocity;
  for (int r = 0; r < n + m; ++r) {
    velocity[r] += acceleration[r] * step;
    impulse[r] += force[r] * step;
  }
  std::vector<std::uint8_t> rests;
  markRests(from, step, band, rests);
  bringToRest(rests);
  for (int i = 0; i < n; ++i) {
    if (rests[i] && from[i] == 0)
      continue;  // held by others
    const double change = (velocity[i] - from[i]) / step;
    restitution.advanceThroughZero(i, from[i], change, step, restitution.exhaustionThroughZero(i, from[i], change) <= step);
  }
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

// Steps over what is nearly zero until nothing is. What these steps neither stop nor start, as the slip of a corner between others that
// stick, is a rounding error; one that grows with each step has a small acceleration.
bool SpatialFrozenPhase::Workspace::settleNearZero(int forced) {
  constexpr int mostSteps = 9;
  int steps = 0;
  bool grows = false;
  for (int k = 0; k <= mostDoublings && (steps < mostSteps || grows) && anyNearZero(); ++k) {
    const double band = stepBand * stillSpeed * std::ldexp(1.0, k);
    const std::vector<double> before = velocity;
    if (stepOver(forced, band / largestChange, band)) {
      ++steps;
      grows = anySlipGrows(before);
    } else if (k == mostDoublings) {
      return false;
    }
  }
  if (anyNearZero())
    stopNearZero();
  return true;
}

// Of those that are still, over a step.
bool SpatialFrozenPhase::Workspace::anySlipGrows(const std::vector<double> &before) const {
  constexpr double clearly = 1.05;
  for (int j = 0; j < m; ++j)
    if (isSlipStill(j) && slipSpeed(j, before) > 0 && slipSpeed(j, velocity) >= clearly * slipSpeed(j, before))
      return true;
  return false;
}

void SpatialFrozenPhase::Workspace::stopNearZero() {
  std::vector<std::uint8_t> rests(n + m, 0);
  for (int i = 0; i < n; ++i)
    rests[i] = isNormalStill(i);
  for (int j = 0; j < m; ++j)
    if (isSlipStill(j))
      rests[n + j] = rests[n + (isPair(j) ? j + 1 : j)] = 1;
  bringToRest(rests);
}

// Where steps follow each other within no time to speak of, leaps over as many of them as possible; where breakpoints do, steps over all
// that may happen, each time further, up to what directions bear: velocities still to be brought to zero end the crowd then.
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
  crowding = std::min(crowding + 1, mostDoublings);
  const double band = stepBand * stillSpeed * std::ldexp(1.0, crowding);
  nextLength = infinity;
  return stepOver(forced, band / largestChange, band);
}

// Many leaps, each as long as possible, where there is no piece to follow: where all forces that could hold a body are at their limits
// together, these neither hold nor let go. False: not even one of this length.
bool SpatialFrozenPhase::Workspace::leapOn(int forced, double shortest) {
  constexpr int mostLeaps = 64;
  constexpr double growth = 1.25;
  const double begin = tau, farthest = longLeap * scale / largestChange;
  bool hasFailed = false;
  double length = shortest;
  for (int k = 0; k < mostLeaps && length >= shortest && anyPushes(); ++k) {
    if (leap(forced, length)) {
      length = std::min(farthest, (hasFailed ? growth : 2) * length);
    } else {
      length *= 0.5;
      hasFailed = true;
    }
  }
  return tau > begin;
}

// Where slips of the leap are decided by its steps and not by their directions, which must be the same ones in all of these.
double SpatialFrozenPhase::Workspace::bandOfLeap(double length) const {
  const double change = length * largestChange;
  double band = stepBand * change;
  const auto isNear = [&](double speed) { return std::abs(speed - band) <= change; };
  for (int r = 0; r < n + m; ++r) {
    const double speed = r < n ? std::abs(velocity[r]) : isSecond(r - n) ? 0 : slipSpeed(r - n, velocity);
    if (isNear(speed)) {
      band = speed + 1.01 * change;
      r = -1;  // others may be near now
    }
  }
  return band;
}

// Over the length by extrapolation of the implicit Euler method, for slips so slow that friction is stiff and their way is smooth all the
// same, as where a force has just left its limit. False, and nothing has changed, where that does not converge.
bool SpatialFrozenPhase::Workspace::leap(int forced, double length) {
  const int count = n + m;
  const std::vector<double> from = velocity;
  const Eigen::Map<const Eigen::VectorXd> start(from.data(), count);
  const double band = bandOfLeap(length);
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
    if (!(rests[i] && from[i] == 0))
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

}  // namespace tf::runtime
