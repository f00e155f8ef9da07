#include "runtime/contact/spatial_frozen_phase.h"

#include "runtime/contact/spatial_frozen_workspace.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

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
  roundingSpeed = std::max(roundingOfSums * scale, at.resolution);
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
  windowSteps = windowBreakpoints = crowding = circling = 0;
  windowBegin = 0;
  startContact = -1;
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

// A friction force of two components is as exact as its direction: its smaller component has the rounding errors of the whole.
void SpatialFrozenPhase::Workspace::updateAcceleration() {
  std::fill(acceleration.begin(), acceleration.end(), 0.0);
  std::fill(turnover.begin(), turnover.end(), 0.0);
  for (int c = 0; c < n + m; ++c) {
    const double size =
        c >= n && problem->partner[c - n] >= 0 ? std::hypot(force[c], force[n + problem->partner[c - n]]) : std::abs(force[c]);
    if (size == 0)
      continue;
    for (int r = 0; r < n + m; ++r) {
      acceleration[r] += problem->delassus(r, c) * force[c];
      turnover[r] += std::abs(problem->delassus(r, c)) * size;
    }
  }
  for (int r = 0; r < n + m; ++r)
    if (std::abs(acceleration[r]) <= roundingOfSums * turnover[r])
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
  // A force that is surely within its limit lets nothing start: what is left of the acceleration is the error of the solution.
  const double size = pair ? std::hypot(force[row], force[row + 1]) : std::abs(force[row]);
  const bool holds = size < problem->friction[j] * ((1 - withinLimit) * force[owner] - 10 * feasibility * problem->rate[owner]);
  if ((holds || length <= motionless * terms) && leaving[row] == 0) {
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
  mode.refer(force);
  return evaluate(forced);
}

// λ and w in the mode at `velocity`. Contacts at zero stay there or leave to the side that their force cannot hold them from: a condition
// that is violated within the solver's tolerance is no motion, from which a contact without force would store an impulse.
bool SpatialFrozenPhase::Workspace::evaluate(int forced) {
  if (!mode.forces(*problem, velocity, stillSpeed, force))
    return false;
  updateAcceleration();
  for (int i = 0; i < n; ++i) {
    if (!restsAt(i) || i == forced)
      continue;
    if (mode.normal[i] == FrozenMode::Normal::Held)
      acceleration[i] = 0;
    else if (mode.normal[i] == FrozenMode::Normal::Off)
      acceleration[i] = std::max(acceleration[i], 0.0);
    else
      acceleration[i] = std::min(acceleration[i], 0.0);
  }
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
    if (std::abs(across) > roundingOfSums * (turnover[n + j] + turnover[n + j + 1]))
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
    if (before * acceleration[r] < 0 && std::abs(velocity[r]) <= roundingOfSums * (std::abs(before) + turnover[r] * duration))
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

// What is left of velocities that slips came to rest from is within what counts as still. An approach no faster than that, or than the one
// that a contact was given to start the impulse, need be none of any motion, and redundant contacts cannot end it; but what it has stopped
// by friction meanwhile would be the work of rounding errors.
bool SpatialFrozenPhase::Workspace::giveUp(bool ends) {
  constexpr double hardly = 1e-5;
  bool any = restitution.giveUp(velocity, force, [this](int) { return stillSpeed; }, ends);
  if (!ends)
    return any;
  for (int j = 0; j < m; ++j)
    if (std::abs(velocity[n + j] - problem->slipVelocity[j]) > hardly * scale)
      return any;
  for (int i = 0; i < n; ++i)
    if (velocity[i] < 0 && velocity[i] >= -(i == startContact ? std::max(stillSpeed, startSpeed) : stillSpeed)) {
      velocity[i] = 0;
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

// Redundant forces that reach a limit are exchanged for others of the same motion, which is no breakpoint; if there are none, all that
// have no room leave their limits together.
void SpatialFrozenPhase::Workspace::exchange(const Watch &event, bool &found) {
  const bool limit = event.kind == Watch::Kind::HeldLow || event.kind == Watch::Kind::HeldHigh || event.kind == Watch::Kind::Stick;
  if (found && limit && mode.isRedundant())
    found = !mode.center(*problem, leaving);
}

// Whether the contact that starts a frictional impulse is pressed in by it. Where D_s is about to reach zero the turn of the slip soon
// makes it negative: until then a small approach keeps the contact pushing. D_s falls as the slip turns, by a part of itself for that part
// of the slip, so that its integral over the impulse is of the size of D_s² times the slip.
bool SpatialFrozenPhase::Workspace::jams(int forced) {
  if (velocity[forced] < 0 || acceleration[forced] < 0)
    return true;
  if (acceleration[forced] > jammed * turnover[forced])
    return false;
  constexpr double enough = 3;
  const double left = acceleration[forced] / turnover[forced];
  startContact = forced;
  startSpeed = std::max(2 * roundingSpeed, enough * scale * left * left);
  velocity[forced] = -startSpeed;
  return true;
}

// A slip that is hardly faster than what counts as still may circle about zero, with friction that turns later than it would: what counts
// as still is more then.
void SpatialFrozenPhase::Workspace::watchCircling(int j) {
  constexpr int patience = 20;
  constexpr double hardly = 10, most = 1e-3;  // of stillSpeed; of the velocities
  if (slipSpeed(j, velocity) > hardly * stillSpeed || stillSpeed > most * scale || ++circling <= patience)
    return;
  circling = 0;
  stillSpeed *= 2;
}

void SpatialFrozenPhase::Workspace::follow(int forced) {
  Watch event;
  FrozenEvent label = FrozenEvent::Start;
  bool found = true;  // a breakpoint: the mode is chosen anew
  int escapes = 0, followed = breakpointLimit;
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
    if (found ? !choose(forced) : !evaluate(forced))
      return fail(FrozenStatus::Unsettled);
    if (restitution.push(force)) {
      found = true;
      continue;
    }
    if (forced >= 0 && !jams(forced))
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
    const bool ends = !turns && !std::isfinite(duration);
    if ((ends || standsStill(acceleration, turnover)) && giveUp(ends)) {
      label = FrozenEvent::Discard;
      found = true;
      continue;
    }
    if (ends)
      return fail(FrozenStatus::Unbounded);
    if (++result.breakpointCount > followed) {
      if (!giveUp(true))
        return fail(FrozenStatus::Cycle);
      label = FrozenEvent::Discard;
      found = true;
      followed += breakpointLimit;
      continue;
    }
    if (turns) {
      if (curve(duration, next.kind == Watch::Kind::PairSlip, event, found)) {
        exchange(event, found);
        escapes = 0;
        if (found && event.kind == Watch::Kind::PairSlip)
          watchCircling(event.index);
        continue;
      }
      const double band = stepBand * stillSpeed * std::ldexp(1.0, ++escapes);
      if (escapes > mostEscapes && leapOn(forced, band / largestChange))
        escapes = 0;
      else if (escapes > mostDoublings || !stepOver(forced, band / largestChange, band))
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
