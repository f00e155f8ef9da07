// The end of a step is moved to the zero of a guard.
#include "runtime/simulate/event_detection.h"
#include "runtime/simulate/zero_bracket.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

// The step's length h is an unknown together with the state: Newton's method on guard(y(t0 + h)) = 0 with the element solved anew for each
// h, until h changes so little that the state moves along dy/dt (trapezoidal rule, error h³) to rounding.
EventDetection::Location EventDetection::locate(DetectedEvent &event) {
  // The slope of the interpolant serves while it leads to the zero.
  constexpr double poor = 0.1, rounding = 1e-14, insensitive = 1e-9, clearly = 30;
  if (integrator_->isExactInside() && moveInside(event))
    return Location::Found;
  if (endsNearby(event))
    return Location::Found;
  const int guard = event.guard;
  const double zero = level(guard);
  const double begin = integrator_->beginTime();
  ZeroBracket bracket(begin, std::max(event.high, event.time));
  const Guard &g = dynamics_.guards()[guard];
  double effect = isForceGuard(g.kind) ? std::numeric_limits<double>::infinity() : 0;  // of the projection on the guard
  double x = event.time, slope = event.slope, previous = x, previousValue = 0;
  for (int k = 0; k < 60; ++k) {
    if (!integrator_->shorten(x))
      return Location::Unsolved;
    // The guard is zero where the event's state will be: on the closed contacts.
    const double correction = dynamics_.project(x, integrator_->end(), integrator_->settings().scale.data());
    double value = guardHere(guard, x) - zero;
    // Stiff forces may be quite other ones there.
    const double near = std::max(effect * clearly, -slope * integrator_->reach() * (x - begin));
    if (correction > rounding && effect > insensitive * g.scale && (k == 0 || std::abs(value) <= near)) {
      if (!dynamics_.evaluate(x, integrator_->end(), integrator_->endRate()))
        return Location::Unsolved;
      const double before = value;
      value = guardHere(guard, x) - zero;
      effect = std::abs(value - before);
    }
    bracket.narrow(x, value < 0);
    if (g.kind == GuardKind::Gap) {
      slope = dynamics_.model().gapRate[g.index];
      // A gap that has just begun to open does so more slowly than a long step is wrong. A fixed step is what it is.
      if (value > 0 && slope >= 0) {
        event.time = x;
        const double later = integrator_->settings().fixedStep > 0 ? bracket.next(std::numeric_limits<double>::infinity()) : x;
        if (!(later > x))
          return Location::Vanished;
        x = later;
        continue;
      }
    } else if (g.kind == GuardKind::Slip && hasJustBegun(guard, value)) {
      // So does a slip whose acceleration has just been zero.
      if (!dynamics_.evaluate(x, integrator_->end(), integrator_->endRate()))
        return Location::Unsolved;
      slope = dynamics_.slipRate(guard);
      if (slope >= 0) {
        disarm([guard](int other) { return other == guard; });
        event.time = x;
        return Location::Vanished;
      }
    } else if (k > 0 && x != previous && std::abs(value) > poor * std::abs(previousValue)) {
      slope = (value - previousValue) / (x - previous);
    }
    previous = x;
    previousValue = value;
    const double way = slope < 0 ? -value / slope : std::numeric_limits<double>::infinity();
    if (std::abs(way) <= integrator_->reach() * (x - begin) && extend(guard, zero, value, slope, x, event))
      return Location::Found;
    if (std::abs(way) <= 1e-5 * (x - begin))
      return nudge(guard, zero, value, slope, x, event) ? Location::Found : Location::Unsolved;
    const double next = bracket.next(x + way);
    if (std::abs(next - x) <= std::numeric_limits<double>::epsilon() * std::abs(x)) {
      event.time = x;
      return Location::Found;
    }
    x = next;
  }
  event.time = x;
  return Location::Found;
}

bool EventDetection::missesZero(const DetectedEvent &event) {
  return dynamics_.guards()[event.guard].kind == GuardKind::Force &&
         std::abs(dynamics_.guardValue(event.guard) - level(event.guard)) > threshold(event.guard);
}

int EventDetection::fallingForce(double time, const double *state, const double *rate) {
  constexpr double zero = 1e-12;
  falling_.clear();
  for (int k = dynamics_.gapGuardCount(); k < static_cast<int>(dynamics_.guards().size()); ++k)
    if (const Guard &g = dynamics_.guards()[k]; g.kind == GuardKind::Force && std::abs(dynamics_.guardValue(k)) <= zero * g.scale)
      falling_.push_back(k);
  if (falling_.empty())
    return -1;
  const double increment = stepAside(time, state, rate);
  int first = -1;
  if (dynamics_.evaluate(time + increment, state_.data(), scratch_.data()))
    if (const auto found = std::find_if(falling_.begin(), falling_.end(),
                                        [this](int k) { return dynamics_.guardValue(k) < -zero * dynamics_.guards()[k].scale; });
        found != falling_.end())
      first = *found;
  return dynamics_.evaluate(time, state, scratch_.data()) ? first : -1;
}

int EventDetection::brokenForce() {
  int worst = -1;
  double least = -1;
  if (dynamics_.isAtPole())
    return worst;
  for (int k = dynamics_.gapGuardCount(); k < static_cast<int>(dynamics_.guards().size()); ++k)
    if (dynamics_.guards()[k].kind == GuardKind::Force && dynamics_.guardValue(k) < least * threshold(k)) {
      least = dynamics_.guardValue(k) / threshold(k);
      worst = k;
    }
  return worst;
}

// A slip that has not left zero before the step: it has by now, or it was the interpolant's error that left it, while the step that ends
// here is still on the other side.
bool EventDetection::hasJustBegun(int guard, double value) const {
  return starts_[guard].armed == Arming::Not ? value > 0 : value < 0 && isArmedNow(guard);
}

// The step has ended so near the zero that the interpolant leads there from its end.
bool EventDetection::endsNearby(DetectedEvent &event) {
  const double end = integrator_->endTime(), length = end - integrator_->beginTime();
  if (!cut_ || !(std::abs(event.time - end) <= integrator_->reach() * length) || !(event.slope < 0))
    return false;
  return dynamics_.evaluate(end, integrator_->end(), integrator_->endRate()) &&
         extend(event.guard, level(event.guard), end_.value[event.guard] - level(event.guard), event.slope, end, event);
}

bool EventDetection::findEarlier(DetectedEvent &event) {
  constexpr double visible = 1e-10, visibleForce = 1e-7, clearForce = 1e-5;  // relative to the guard's scale
  const auto isOther = [&](int k) {
    const GuardKind kind = dynamics_.guards()[k].kind;
    return k != event.guard && (kind == GuardKind::Gap || kind == GuardKind::Force);
  };
  if (std::none_of(awake_.begin(), awake_.end(), isOther))
    return false;
  DetectedEvent earlier;
  const double begin = integrator_->beginTime();
  readGuards(event.time, end_);
  for (const int k : awake_) {
    if (!isOther(k))
      continue;
    const Guard &guard = dynamics_.guards()[k];
    const bool isForce = guard.kind == GuardKind::Force;
    // A force has no rate of its own, and one that begins near zero may be below by an error.
    const bool beginsNearZero = isForce && !(begin_.value[k] > visibleForce * guard.scale);
    const double value = end_.value[k] - level(k), least = (beginsNearZero ? clearForce : isForce ? visibleForce : visible) * guard.scale;
    if (!(value < -least))
      continue;
    const double rate = isForce ? (value - begin_.value[k]) / (event.time - begin) : end_.rate[k];
    double time = rate < 0 ? event.time - value / rate : begin;
    if (!(time > begin))
      time = 0.5 * (begin + event.time);
    if (earlier.guard < 0 || time < earlier.time)
      earlier = {k, time, begin, event.time, rate};
  }
  if (earlier.guard < 0)
    return false;
  event = earlier;
  return true;
}

bool EventDetection::returnToZero(const DetectedEvent &event) {
  constexpr double visible = 1e-12, farthest = 1e-4;  // of the guard's scale, of the step
  const Guard &g = dynamics_.guards()[event.guard];
  if (g.kind != GuardKind::Gap && g.kind != GuardKind::Slip)
    return false;
  const double end = integrator_->endTime(), resolution = 4 * std::numeric_limits<double>::epsilon() * std::abs(end);
  // The interpolant has no slope to tell where its zero was found at once.
  double slope = event.slope;
  if (g.kind == GuardKind::Slip && !(slope < 0) && dynamics_.evaluate(end, integrator_->end(), integrator_->endRate()))
    slope = dynamics_.slipRate(event.guard);
  // Late times are so coarse that the zero lies between two of them, clearly off both.
  if (!dynamics_.needsProjection() && resolution * std::abs(slope) <= visible * g.scale)
    return false;
  const double value = guardAt(event.guard, end, integrator_->end()) - level(event.guard);
  if (g.kind == GuardKind::Gap)
    slope = dynamics_.model().gapRate[g.index];
  const double duration = -value / slope;
  if (!(slope < 0) || std::abs(value) <= visible * g.scale ||
      !(std::abs(duration) <= std::max(farthest * (end - integrator_->beginTime()), resolution)))
    return false;
  for (int i = 0; i < dynamics_.size(); ++i)
    integrator_->end()[i] += duration * integrator_->endRate()[i];
  integrator_->moveEnd(end + duration);
  return true;
}

// Where the interpolant is exact, its zero is the event: Newton's method on it. False: it leaves the bracket.
bool EventDetection::moveInside(DetectedEvent &event) {
  const double zero = level(event.guard), begin = integrator_->beginTime();
  const double resolution = 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(event.time), event.time - begin);
  const Guard &g = dynamics_.guards()[event.guard];
  double x = event.time, slope = event.slope, previous = x, previousValue = 0;
  for (int k = 0; k < 12; ++k) {
    const double value = guardInside(event.guard, x) - zero;
    if (g.kind == GuardKind::Gap)
      slope = dynamics_.model().gapRate[g.index];
    else if (k > 0 && value != previousValue && std::abs(x - previous) > 8 * resolution)
      slope = (value - previousValue) / (x - previous);
    if (!(slope < 0))
      return false;
    const double step = -value / slope;
    previous = x;
    previousValue = value;
    // The other side of a switch that slides becomes consistent only where its step variable has left the interval.
    const bool isBefore = (g.kind == GuardKind::StepLow || g.kind == GuardKind::StepHigh) && value > 0;
    if ((std::abs(step) <= resolution && !isBefore) || (g.kind == GuardKind::Force && std::abs(value) <= 1e-13 * g.scale)) {
      if (g.kind == GuardKind::Gap && x + step > begin)
        x = std::min(x + step, event.high);
      event.time = x;
      return (g.kind != GuardKind::Slip || isBetweenEnds(x)) && integrator_->moveInside(x);
    }
    x += isBefore ? std::max(step, 0.5 * resolution) : step;
    if (!(x > begin && x <= event.high))
      return false;
  }
  return false;
}

// Friction that depends on the slip may have a peak where this ends, which no evaluation of the step has met. Whether the rate at `time`,
// in state_, lies between those at the ends of the step, within the tolerance of their effect.
bool EventDetection::isBetweenEnds(double time) {
  if (!dynamics_.frictionMayPeak())
    return true;
  if (!dynamics_.evaluate(time, state_.data(), scratch_.data()))
    return false;
  const IntegratorSettings &settings = integrator_->settings();
  const double length = integrator_->endTime() - integrator_->beginTime(), theta = (time - integrator_->beginTime()) / length;
  for (int i = 0; i < dynamics_.size(); ++i) {
    const double expected = integrator_->beginRate()[i] + theta * (integrator_->endRate()[i] - integrator_->beginRate()[i]);
    if (length * std::abs(scratch_[i] - expected) > settings.tolerance * std::max(settings.scale[i], std::abs(state_[i])))
      return false;
  }
  return true;
}

// The same of a rate that goes on from the end of the step at `base`.
bool EventDetection::goesOnFrom(double base, double time) {
  if (!dynamics_.frictionMayPeak())
    return true;
  if (!dynamics_.evaluate(time, state_.data(), scratch_.data()))
    return false;
  const IntegratorSettings &settings = integrator_->settings();
  for (int i = 0; i < dynamics_.size(); ++i)
    if (std::abs((time - base) * (scratch_[i] - integrator_->endRate()[i])) >
        settings.tolerance * std::max(settings.scale[i], std::abs(state_[i])))
      return false;
  return true;
}

// From the element's end at `base`, projected, along the interpolant to the zero nearby; the rate at the end stays that at `base`. False:
// no zero within the interpolant's reach.
bool EventDetection::extend(int guard, double zero, double value, double slope, double base, DetectedEvent &event) {
  // So near an end the curve through both of them is off by a part of the error of the step.
  constexpr double near = 1e-4;
  fromEnds_ = integrator_->isInterpolantDear() && std::abs(value / slope) <= near * (base - integrator_->beginTime());
  const bool found = followInterpolant(guard, zero, value, slope, base, event);
  fromEnds_ = false;
  return found;
}

bool EventDetection::followInterpolant(int guard, double zero, double value, double slope, double base, DetectedEvent &event) {
  const double farthest = integrator_->reach() * (base - integrator_->beginTime());
  const double resolution = 0.5 * std::numeric_limits<double>::epsilon() * std::max(std::abs(base), base - integrator_->beginTime());
  const int n = dynamics_.size();
  double x = base;
  interpolate(base);
  nudgeBase_.resize(n);
  for (int i = 0; i < n; ++i)
    nudgeBase_[i] = integrator_->end()[i] - state_[i];
  const bool isGap = dynamics_.guards()[guard].kind == GuardKind::Gap;
  // Forces cost an evaluation: they need not be smaller than what the choice of the next mode takes for zero.
  const double small = dynamics_.guards()[guard].kind == GuardKind::Force ? 1e-13 * dynamics_.guards()[guard].scale : 0;
  for (int k = 0; k < 8 && !(std::abs(value) <= small && small > 0); ++k) {
    const double next = x - value / slope;
    if (!(std::abs(next - base) <= farthest))
      return false;
    if (std::abs(next - x) <= resolution)
      break;
    const double before = value, step = next - x;
    x = next;
    interpolate(x);
    for (int i = 0; i < n; ++i)
      state_[i] += nudgeBase_[i];
    value = guardAt(guard, x, state_.data()) - zero;
    if (isGap)
      slope = dynamics_.model().gapRate[dynamics_.guards()[guard].index];
    else if (value != before && std::abs(step) > 8 * resolution)
      slope = (value - before) / step;
    if (!(slope < 0))
      return false;
    // A tiny step that brings it no nearer to zero: what is left is rounding.
    if (std::abs(step) <= 64 * resolution && std::abs(value) > 0.5 * std::abs(before))
      break;
  }
  if (dynamics_.guards()[guard].kind == GuardKind::Slip && !goesOnFrom(base, x))
    return false;
  if (x != base) {
    std::copy(state_.begin(), state_.end(), integrator_->end());
    integrator_->moveEnd(x);
  }
  event.time = x;
  return true;
}

// From the element's end at `base`, where the dynamics has been evaluated, to the zero nearby.
bool EventDetection::nudge(int guard, double zero, double value, double slope, double base, DetectedEvent &event) {
  const int n = dynamics_.size();
  nudgeBase_.assign(integrator_->end(), integrator_->end() + n);
  nudgeRate_.assign(integrator_->endRate(), integrator_->endRate() + n);
  double x = base, previous = base, previousValue = value;
  const double length = base - integrator_->beginTime(), farthest = 1e-4 * length;
  const double resolution = std::numeric_limits<double>::epsilon() * std::max(std::abs(base), length);
  for (int k = 0; k < 8 && value != 0; ++k) {
    const double step = -value / slope;
    previous = x;
    previousValue = value;
    // A guard that is not smooth here may send the zero anywhere.
    if (std::abs(step) <= 0.5 * resolution || !(std::abs(x + step - base) <= farthest))
      break;
    x += step;
    const double h = x - base;
    for (int i = 0; i < n; ++i)
      state_[i] = nudgeBase_[i] + h * nudgeRate_[i];
    if (!dynamics_.evaluate(x, state_.data(), integrator_->endRate()))
      return false;
    for (int i = 0; i < n; ++i)
      integrator_->end()[i] = nudgeBase_[i] + 0.5 * h * (nudgeRate_[i] + integrator_->endRate()[i]);
    value = guardAt(guard, x, integrator_->end()) - zero;
    if (std::isnan(value))
      return false;
    if (x != previous && value != previousValue && std::abs(x - previous) > 4 * resolution)
      slope = (value - previousValue) / (x - previous);
    if (!(slope < 0))
      break;
  }
  event.time = x;
  integrator_->moveEnd(x);
  return dynamics_.evaluate(x, integrator_->end(), integrator_->endRate());
}

}  // namespace tf::runtime
