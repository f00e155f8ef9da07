// What the values and rates of guards at the ends of a step tell of zeros inside it, without samples on the interpolant.
#include "runtime/integrate/parabola_zero.h"
#include "runtime/simulate/cubic_hermite.h"
#include "runtime/simulate/event_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

// A guard that the step cannot have taken to zero, by its rates at both ends. Those of a condition tell nothing: it may be any function.
bool EventDetection::isFar(int guard) const {
  const double h = end_.time - begin_.time, a = begin_.rate[guard], b = end_.rate[guard];
  return dynamics_.guards()[guard].kind != GuardKind::Condition && starts_[guard].armed != Arming::Not &&
         std::min(begin_.value[guard], end_.value[guard]) > 2 * h * std::max({std::abs(a), std::abs(b), std::abs(b - a)});
}

// A force that dips nowhere in the step where the method has evaluated it; between these places, near an end, it could dip by a hundredth
// of its change at most.
bool EventDetection::isSteady(int guard) const {
  constexpr double visible = 0.02;
  const double least = dynamics_.leastMargin(guard), a = begin_.value[guard], b = end_.value[guard];
  return starts_[guard].armed != Arming::Not && integrator_->samplesInside() &&
         least > std::max({0.0, 0.5 * std::min(a, b), visible * std::max({a, b, dynamics_.largestMargin(guard)})});
}

// Where all guards are gaps that are cubic functions of time over a step that is long for want of errors, as in free flight: their zeros
// are those of the cubics through the ends. False: they are not.
bool EventDetection::examineCubics(DetectedEvent &first) {
  if (!integrator_->isExactInside())
    return false;
  const tf_contact *contacts = dynamics_.model().model().contacts;
  bool areParabolas = integrator_->isUniform();
  for (const int k : awake_) {
    if (isSampled(k))
      continue;
    const Guard &guard = dynamics_.guards()[k];
    if (guard.kind != GuardKind::Gap || starts_[k].armed == Arming::Not)
      return false;
    areParabolas = areParabolas && contacts[guard.index].gap_is_affine != 0;
  }
  if (!areParabolas && !fitCubics())
    return false;
  first = {};
  for (const int k : awake_)
    if (!isSampled(k) && !(areParabolas ? parabolaEvent(k, first) : cubicZero(k, first)))
      return false;
  return true;
}

// The first zero of a gap along a parabola, from its begin: a hop may be any part of the step. False: it is not clear.
bool EventDetection::parabolaEvent(int guard, DetectedEvent &first) const {
  const double a = begin_.value[guard], da = begin_.rate[guard], zero = level(guard);
  const double acceleration = (end_.rate[guard] - da) / (end_.time - begin_.time);
  const bool opens = a <= threshold(guard);
  if (opens ? !(da > 0 && a >= -threshold(guard)) : !(a > zero))
    return false;
  const double place = parabolaZero(opens ? 0 : a - zero, da, acceleration), time = begin_.time + place;
  if (end_.value[guard] - zero >= 0)
    return !(time < end_.time);
  const double slope = da + acceleration * place;
  if (!(time > begin_.time && time < end_.time && slope < 0))
    return false;
  if (first.guard < 0 || time < first.time)
    first = {guard, time, begin_.time, end_.time, slope};
  return true;
}

// Whether gaps are the cubics through the ends of the step: a sample at a place that no period divides is the proof, where the step does
// not lead so far that a gap may be another function on the way.
bool EventDetection::fitCubics() {
  constexpr double place = 0.5 * 0.3819660112501051;
  constexpr double accepted = 1e-9;
  const double h = end_.time - begin_.time;
  if (intervalCount() > 2 || !sampleInside(begin_.time + place * h, false, inner_[0]))
    return false;
  for (const int k : awake_) {
    if (isSampled(k))
      continue;
    const double a = begin_.value[k], b = end_.value[k], da = begin_.rate[k], db = end_.rate[k];
    const double size = std::max({std::abs(a), std::abs(b), h * std::abs(da), h * std::abs(db)});
    if (!(std::abs(CubicHermite{a, da, b, db, h}.value(place) - inner_[0].value[k]) <= accepted * size))
      return false;
  }
  return true;
}

// The first zero of the cubic through the ends of the step, at least a part of it away from its begin. False: it is not clear.
bool EventDetection::cubicZero(int guard, DetectedEvent &first) const {
  const double a = begin_.value[guard], b = end_.value[guard], da = begin_.rate[guard], db = end_.rate[guard];
  const double h = end_.time - begin_.time, zero = level(guard);
  const bool opens = a <= threshold(guard);
  if (opens && !(da > 0 && a >= -threshold(guard)))
    return false;
  if (b - zero >= 0) {
    const double least = CubicHermite{a, da, b, db, h}.interiorMinimum();
    return std::min(least, b) - zero > threshold(guard) || (least == std::numeric_limits<double>::infinity() && b - zero > 0);
  }
  const double place = db < 0 ? CubicHermite{opens ? 0 : a - zero, da, b - zero, db, h}.lastZero() : -1;
  // The cubic is positive all the way to there if it rises at its begin or falls from a positive value, and bends down only.
  const double bend = 6 * (b - a) - 2 * h * (2 * da + db), bendAtEnd = 6 * (a - b) + 2 * h * (da + 2 * db);
  if (!(place > 1e-3) || bend > 0 || bendAtEnd > 0)
    return false;
  const double time = begin_.time + place * h;
  if (first.guard < 0 || time < first.time)
    first = {guard, time, begin_.time, end_.time, CubicHermite{a, da, b, db, h}.slope(place) / h};
  return true;
}

// Where forces do not end the mode, and the interpolant costs evaluations: whether the curve through the states and rates at the ends of
// the step shows that no guard falls to zero, or that one of them does, all the way, and the others do not. The event is located on the
// step itself, so that its time here is a first guess. False: it does not show it.
bool EventDetection::examineEndsAlone(DetectedEvent &first) {
  if (!integrator_->isInterpolantDear() || watched_ || intervalCount() > 2)
    return false;
  int falling = -1;
  for (const int k : awake_) {
    if (isSampled(k) || isForceGuard(dynamics_.guards()[k].kind) || isFar(k))
      continue;
    const bool falls = end_.value[k] < level(k);
    if (starts_[k].armed == Arming::Not || begin_.value[k] <= threshold(k) || (falls && falling >= 0))
      return false;
    if (falls)
      falling = k;
  }
  fromEnds_ = true;
  Sample &middle = inner_[0];
  (void)sampleInside(begin_.time + unevenPart * (end_.time - begin_.time), false, middle);
  measureEnds(middle);
  bool isClear = othersStayPositive(falling, begin_, middle, 1, &middle) && othersStayPositive(falling, middle, end_, 1, &middle);
  if (falling >= 0 && isClear) {
    isClear = std::max({begin_.rate[falling], middle.rate[falling], end_.rate[falling]}) < 0;
    if (isClear)
      bracket(falling, begin_, end_, first);
  }
  fromEnds_ = false;
  return isClear;
}

// What the curve through the states and rates at the ends may be off by, in each guard: a part of how far it is from the cubic through the
// guard's values and rates there, which is of an order less by two.
void EventDetection::measureEnds(Sample &middle) {
  constexpr double part = 0.1;
  const double h = end_.time - begin_.time;
  endsError_.resize(middle.value.size());
  middle.misfit.resize(middle.value.size());
  for (const int k : awake_) {
    const CubicHermite whole{begin_.value[k], begin_.rate[k], end_.value[k], end_.rate[k], h};
    middle.misfit[k] =
        std::max(std::abs(whole.value(unevenPart) - middle.value[k]), 0.25 * std::abs(whole.slope(unevenPart) - h * middle.rate[k]));
    endsError_[k] = part * middle.misfit[k];
  }
}

// All guards with rates but one, by samples from the ends of the step. False: it is not clear.
bool EventDetection::othersStayPositive(int except, const Sample &a, const Sample &b, int depth, const Sample *coarser) {
  constexpr int deepestByEnds = 3;
  const auto mayFall = [&](int k) { return k != except && !isSampled(k) && mayDip(k, a, b); };
  if (std::any_of(awake_.begin(), awake_.end(), [&](int k) { return mayFall(k) && b.value[k] < level(k); }))
    return false;
  if (std::none_of(awake_.begin(), awake_.end(), mayFall))
    return true;
  if (depth > deepestByEnds)
    return false;
  Sample &middle = pool_[static_cast<std::size_t>(depth)];
  sampleInside(a.time + unevenPart * (b.time - a.time), false, middle);
  forgetMisfits(middle);
  if (std::none_of(awake_.begin(), awake_.end(), [&](int k) { return mayFall(k) && isUnclear(k, a, middle, b, coarser); }))
    return true;
  return othersStayPositive(except, a, middle, depth + 1, &middle) && othersStayPositive(except, middle, b, depth + 1, &middle);
}

}  // namespace tf::runtime
