// The zero of a guard between two samples of different signs, on the interpolant.
#include "runtime/simulate/cubic_hermite.h"
#include "runtime/simulate/event_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// To what part of a bracket it is found; `locate` goes on from there.
constexpr double located = 1e-6;

}  // namespace

// A zero of a gap, which has a rate, by Newton's method in the bracket; `x` is the first guess.
void EventDetection::newtonZero(int guard, double zero, double x, DetectedEvent &event) {
  const int contact = dynamics_.guards()[guard].index;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  // A low hop is only so many roundings of the gap high: its end is no better known than to these.
  const double roundingOfGap = 8 * epsilon * dynamics_.guards()[guard].scale;
  // Times are rounded.
  const double least = std::max(1e-12 * (event.high - event.low), 4 * epsilon * std::abs(event.high));
  double a = event.low, b = event.high, previous = 0;
  for (int k = 0; k < 60; ++k) {
    const double value = guardInside(guard, x) - zero;
    event.slope = dynamics_.model().gapRate[contact];
    (value >= 0 ? a : b) = x;
    event.time = x;
    const double accuracy = located * (x - event.low) + least;
    double next = x - value / event.slope;
    const bool isNewton = event.slope < 0 && next > a && next < b;
    // The zero may be at x itself, which is an end of the bracket now.
    if (!isNewton && event.slope < 0 && std::abs(next - x) <= least)
      return;
    if (!isNewton)
      next = 0.5 * (a + b);
    const double step = std::abs(next - x);
    // Quadratic convergence: the step after this one would be step (step/previous)². Once it has come near, rounding of the values keeps
    // later steps from becoming shorter.
    const bool isSlow = !isNewton || (previous > 0 && step >= 0.5 * previous);
    if (k > 0 && isSlow && std::abs(value) <= roundingOfGap)
      return;
    const bool isRounding = isNewton && isSlow && step <= 1e-8 * (event.high - event.low);
    if (step <= accuracy || isRounding || (isNewton && step < 0.1 * previous && step * step * step <= accuracy * previous * previous)) {
      event.time = next;
      return;
    }
    previous = isNewton ? step : 0;
    x = next;
  }
}

// By the Illinois method, until the estimates agree to a part of the bracket: forces cost an evaluation each time.
void EventDetection::illinoisZero(int guard, double zero, double lowValue, double highValue, DetectedEvent &event) {
  const double accuracy = lowValue <= 0 ? 1e-9 : isForceGuard(dynamics_.guards()[guard].kind) ? 1e-5 : located;
  double a = event.low, fa = lowValue, b = event.high, fb = highValue;
  double weightA = 1, weightB = 1;  // of the values, in the interpolation
  int side = 0;
  const double smallest = 8 * std::numeric_limits<double>::epsilon() * std::abs(b), close = accuracy * (b - a);
  double last = b, lastValue = fb;
  event.time = b;
  for (int k = 0; k < 80 && b - a > (fa > 0 ? close : smallest); ++k) {
    const double pa = weightA * fa, pb = weightB * fb;
    // A gap that starts at zero is positive before it returns: halved until that is seen, however soon the return is.
    const bool interpolated = fa > 0;
    double x = interpolated ? (pa * b - pb * a) / (pa - pb) : 0.5 * (a + b);
    // Where an end is the zero but for rounding, a little step away from it shows that.
    if (interpolated)
      x = std::clamp(x, a + 0.25 * close, b - 0.25 * close);
    if (!(x > a && x < b))
      x = 0.5 * (a + b);
    const double fx = guardInside(guard, x) - zero;
    if (std::isnan(fx))
      break;
    // A secant over a distance at which the values are more than rounding.
    if (std::abs(x - last) > 10 * close)
      event.slope = (fx - lastValue) / (x - last);
    if (fx == 0 && interpolated) {
      event.time = x;
      break;
    }
    (fx >= 0 ? a : b) = x;
    (fx >= 0 ? fa : fb) = fx;
    if (fx >= 0) {
      weightA = 1;
      weightB = side == 1 ? 0.5 * weightB : 1;
      side = 1;
    } else {
      weightB = 1;
      weightA = side == -1 ? 0.5 * weightA : 1;
      side = -1;
    }
    // Where the guard has changed its sign.
    event.time = fx < 0 ? x : std::min(b, x + close);
    const bool rises = fx > 0 && lastValue > 0 && (fx - lastValue) * (x - last) > 0;
    if (interpolated && std::abs(x - last) <= close && !rises)
      break;
    last = interpolated ? x : b;
    lastValue = interpolated ? fx : fb;
  }
}

// Whether the guard, which has fallen between the samples, has not yet done so at the first event that has been found: of many guards only
// the first is wanted, and all are read there at once. Slips that one motion brings to zero together differ by rounding.
bool EventDetection::fallsLater(int guard, const DetectedEvent &first) {
  constexpr double rounding = 1e-12;  // relative to the slip's scale
  const Guard &g = dynamics_.guards()[guard];
  if (isForceGuard(g.kind))
    return guardInside(guard, first.time) >= level(guard);
  if (first_.time != first.time)
    sampleInside(first.time, false, first_);
  const bool isSame = g.kind == GuardKind::Slip && dynamics_.guards()[first.guard].kind == GuardKind::Slip &&
                      std::abs(first_.value[guard] - first_.value[first.guard]) <= rounding * g.scale;
  return isSame || first_.value[guard] >= level(guard);
}

// The first zero of a guard between samples of different signs, on the interpolant.
void EventDetection::bracket(int guard, const Sample &low, const Sample &high, DetectedEvent &first) {
  if (first.guard >= 0 && (low.time >= first.time || (first.time < high.time && (first.guard == guard || fallsLater(guard, first)))))
    return;
  const double zero = level(guard);
  // Guards that leave zero within rounding are at it, whatever their level.
  const bool leavesZero = starts_[guard].armed == Arming::Not && !isForceGuard(dynamics_.guards()[guard].kind);
  const double atLow = leavesZero ? 0 : std::max(low.value[guard] - zero, 0.0), atHigh = high.value[guard] - zero;
  DetectedEvent event{guard, high.time, low.time, high.time, 0};
  // Of a gap that starts at zero the other zero is wanted, which Newton's method finds from the right unless it is very near; where the
  // start is not followed to rounding, the gap must be known to have opened.
  const bool opens = starts_[guard].armed != Arming::Not || startsToRounding_;
  const bool falls = dynamics_.guards()[guard].kind == GuardKind::Gap && opens && high.rate[guard] < 0;
  if (falls) {
    const double h = high.time - low.time;
    const double place = CubicHermite{atLow, low.rate[guard], atHigh, high.rate[guard], h}.lastZero();
    const double tangent = high.time - atHigh / high.rate[guard];
    newtonZero(guard, zero, place > 0 ? low.time + place * h : std::max(tangent, 0.5 * (low.time + high.time)), event);
  }
  // A gap that rises at first has its other zero where it falls, however soon.
  const double nearest = low.rate[guard] > 0 ? 1e-6 : 1e-3;
  if (!falls || (atLow <= 0 && !(event.slope < 0 && event.time - low.time > nearest * (high.time - low.time))))
    illinoisZero(guard, zero, atLow, atHigh, event);
  if (first.guard < 0 || event.time < first.time)
    first = event;
}

}  // namespace tf::runtime
