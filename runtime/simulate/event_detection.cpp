#include "runtime/simulate/event_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

bool isForceGuard(GuardKind kind) { return kind == GuardKind::Force || kind == GuardKind::StepLow || kind == GuardKind::StepHigh; }

// Of a gap, relative to its scale.
constexpr double rounding = 1e-12;

constexpr int deepest = 12;  // bisections of a step in the search for a gap that dips

// Cubic Hermite interpolant on [0, h] at s in [0, 1].
double hermite(double a, double da, double b, double db, double h, double s) {
  const double r = 1 - s;
  return r * r * (1 + 2 * s) * a + s * s * (3 - 2 * s) * b + h * s * r * (r * da - s * db);
}

// The interpolant's least value inside (0, 1), infinity where it has no interior minimum.
double hermiteMinimum(double a, double da, double b, double db, double h, double &place) {
  // Derivative (in s): 3 p s² + 2 q s + r.
  const double p = 2 * (a - b) + h * (da + db);
  const double q = 3 * (b - a) - h * (2 * da + db);
  const double r = h * da;
  const double discriminant = q * q - 3 * p * r;
  place = -1;
  if (discriminant < 0)
    return std::numeric_limits<double>::infinity();
  const double root = std::sqrt(discriminant);
  // The minimum is the root where the second derivative is positive.
  const double s = q + root != 0 ? -r / (q + root) : std::numeric_limits<double>::infinity();
  if (!(s > 0 && s < 1))
    return std::numeric_limits<double>::infinity();
  place = s;
  return hermite(a, da, b, db, h, s);
}

}  // namespace

EventDetection::EventDetection(ModeDynamics &dynamics, SmoothIntegrator &integrator)
    : dynamics_(dynamics), integrator_(&integrator), pool_(deepest + 1), state_(dynamics.size()), scratch_(dynamics.size()) {}

// Magnitude below which a guard that starts at zero has not clearly left it: the integrator's error.
double EventDetection::threshold(int guard) const {
  const Guard &g = dynamics_.guards()[guard];
  const double tolerance = integrator_->settings().tolerance;
  return (isForceGuard(g.kind) ? std::max(1e-9, tolerance) : integrator_->startingError()) * g.scale;
}

// Where a hop begins and ends: zero, but for a gap that starts clearly below it.
double EventDetection::hopBase(int guard) const { return start_[guard] < -rounding * dynamics_.guards()[guard].scale ? start_[guard] : 0; }

// The value below which the guard has ended the mode: one that starts at zero, or below it by the integrator's error, must fall further.
double EventDetection::level(int guard) const {
  switch (armed_[guard]) {
  case Arming::ByValue:
    return 0;
  case Arming::BySpeed:
    return hopBase(guard);
  case Arming::Not:
    break;
  }
  return std::min(start_[guard], 0.0) - threshold(guard);
}

// A gap that leaves zero at a tiny speed returns before it can be told from rounding; the integral of its rate (trapezoidal rule, exact for
// a ballistic hop) shows it all the same.
double EventDetection::hop(int guard, double time, double gap, double rate) const {
  const double scale = dynamics_.guards()[guard].scale, base = hopBase(guard);
  if (!integrator_->startsToRounding() || start_[guard] > rounding * scale || std::abs(gap - base) > rounding * scale)
    return gap;
  const double integral = 0.5 * (time - startTime_) * (startRate_[guard] + rate);
  return std::abs(integral) <= 10 * rounding * scale ? base + integral : gap;
}

void EventDetection::readGuards(double time, Sample &sample) {
  sample.time = time;
  sample.value.resize(dynamics_.guards().size());
  sample.rate.resize(dynamics_.guards().size());
  dynamics_.guardValues(sample.value.data());
  dynamics_.guardRates(sample.rate.data());
  for (std::size_t k = 0; k < dynamics_.guards().size(); ++k)
    if (dynamics_.guards()[k].kind == GuardKind::Gap)
      sample.value[k] = hop(static_cast<int>(k), time, sample.value[k], sample.rate[k]);
}

// Without forces the values of their guards mean nothing.
bool EventDetection::sampleInside(double time, bool withForces, Sample &sample) {
  integrator_->interpolate(time, state_.data());
  if (!withForces || !needsForces_)
    dynamics_.model().setPoint(time, state_.data());
  else if (!dynamics_.evaluate(time, state_.data(), scratch_.data()))
    return false;
  readGuards(time, sample);
  return true;
}

double EventDetection::guardAt(int guard, double time, const double *state) {
  const bool isForce = isForceGuard(dynamics_.guards()[guard].kind);
  if (isForce && !dynamics_.evaluate(time, state, scratch_.data()))
    return std::numeric_limits<double>::quiet_NaN();
  if (!isForce)
    dynamics_.model().setPoint(time, state);
  const double value = dynamics_.guardValue(guard);
  const Guard &g = dynamics_.guards()[guard];
  return g.kind == GuardKind::Gap ? hop(guard, time, value, dynamics_.model().gapRate[g.index]) : value;
}

double EventDetection::guardInside(int guard, double time) {
  integrator_->interpolate(time, state_.data());
  return guardAt(guard, time, state_.data());
}

void EventDetection::restart(double time, double speedOfRounding) {
  const std::size_t count = dynamics_.guards().size();
  needsForces_ =
      std::any_of(dynamics_.guards().begin(), dynamics_.guards().end(), [](const Guard &guard) { return isForceGuard(guard.kind); });
  start_.assign(count, std::numeric_limits<double>::infinity());
  startTime_ = time;
  readGuards(time, begin_);
  start_ = begin_.value;
  startRate_ = begin_.rate;
  armed_.assign(count, Arming::Not);
  // A gap that opens at a speed needs no distance to be taken for open.
  for (std::size_t k = 0; k < count; ++k) {
    const double least = threshold(static_cast<int>(k));
    const bool opens = integrator_->startsToRounding() ? begin_.rate[k] > speedOfRounding
                                                       : begin_.rate[k] > 1e3 * least && begin_.value[k] > -1e-3 * least;
    armed_[k] = begin_.value[k] > least ? Arming::ByValue : opens ? Arming::BySpeed : Arming::Not;
  }
}

void EventDetection::watchStart() {
  watched_ = false;
  for (std::size_t k = 0; k < armed_.size(); ++k)
    watched_ = watched_ || (dynamics_.guards()[k].kind == GuardKind::Gap && begin_.value[k] <= threshold(static_cast<int>(k)));
  integrator_->setCareful(watched_);
}

// A zero of a gap, which has a rate, by Newton's method in the bracket; `x` is the first guess.
void EventDetection::newtonZero(int guard, double zero, double x, DetectedEvent &event) {
  const int contact = dynamics_.guards()[guard].index;
  // Of times, which are rounded.
  const double accuracy = std::max(1e-12 * (event.high - event.low), 4 * std::numeric_limits<double>::epsilon() * std::abs(event.high));
  double a = event.low, b = event.high, previous = 0;
  for (int k = 0; k < 60; ++k) {
    const double value = guardInside(guard, x) - zero;
    event.slope = dynamics_.model().gapRate[contact];
    (value >= 0 ? a : b) = x;
    event.time = x;
    double next = x - value / event.slope;
    const bool isNewton = event.slope < 0 && next > a && next < b;
    if (!isNewton)
      next = 0.5 * (a + b);
    const double step = std::abs(next - x);
    // Quadratic convergence: the step after this one would be step (step/previous)². Once it has come near, rounding of the values keeps
    // later steps from becoming shorter.
    const bool isRounding = isNewton && previous > 0 && step >= 0.5 * previous && step <= 1e-8 * (event.high - event.low);
    if (step <= accuracy || isRounding || (isNewton && step < 0.1 * previous && step * step * step <= accuracy * previous * previous)) {
      event.time = next;
      return;
    }
    previous = isNewton ? step : 0;
    x = next;
  }
}

// By the Illinois method, until the estimates agree.
void EventDetection::illinoisZero(int guard, double zero, double lowValue, double highValue, DetectedEvent &event) {
  double a = event.low, fa = lowValue, b = event.high, fb = highValue;
  double weightA = 1, weightB = 1;  // of the values, in the interpolation
  int side = 0;
  const double smallest = 8 * std::numeric_limits<double>::epsilon() * std::abs(b), close = 1e-9 * (b - a);
  double last = b, lastValue = fb;
  event.time = b;
  for (int k = 0; k < 80 && b - a > (fa > 0 ? close : smallest); ++k) {
    const double pa = weightA * fa, pb = weightB * fb;
    // A gap that starts at zero is positive before it returns: halved until that is seen, however soon the return is.
    const bool interpolated = fa > 0;
    double x = interpolated ? (pa * b - pb * a) / (pa - pb) : 0.5 * (a + b);
    if (!(x > a && x < b))
      x = 0.5 * (a + b);
    const double fx = guardInside(guard, x) - zero;
    if (std::isnan(fx))
      break;
    // A secant over a distance at which the values are more than rounding.
    if (std::abs(x - last) > 10 * close)
      event.slope = (fx - lastValue) / (x - last);
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
    if (interpolated && std::abs(x - last) <= close)
      break;
    last = interpolated ? x : b;
    lastValue = interpolated ? fx : fb;
  }
}

// The first zero of a guard between samples of different signs, on the interpolant.
void EventDetection::bracket(int guard, const Sample &low, const Sample &high, DetectedEvent &first) {
  if (first.guard >= 0 && low.time >= first.time)
    return;
  const double zero = level(guard);
  // Of many guards that fall in the step only the first is wanted.
  if (first.guard >= 0 && first.time < high.time && guardInside(guard, first.time) >= zero)
    return;
  const double atLow = std::max(low.value[guard] - zero, 0.0), atHigh = high.value[guard] - zero;
  DetectedEvent event{guard, high.time, low.time, high.time, 0};
  const double secant = (low.time * atHigh - high.time * atLow) / (atHigh - atLow);
  // Of a gap that starts at zero the other zero is wanted, which Newton's method finds from the right unless it is very near; where the
  // start is not followed to rounding, the gap must be known to have opened.
  const bool opens = armed_[guard] != Arming::Not || integrator_->startsToRounding();
  const bool falls = dynamics_.guards()[guard].kind == GuardKind::Gap && opens && high.rate[guard] < 0;
  if (falls)
    newtonZero(guard, zero, std::max(high.time - atHigh / high.rate[guard], secant), event);
  if (!falls || (atLow <= 0 && !(event.slope < 0 && event.time - low.time > 1e-3 * (high.time - low.time))))
    illinoisZero(guard, zero, atLow, atHigh, event);
  if (first.guard < 0 || event.time < first.time)
    first = event;
}

// A gap that may come near zero between the samples: its own rates could take it there.
bool EventDetection::mayDip(int guard, const Sample &a, const Sample &b) const {
  if (dynamics_.guards()[guard].kind != GuardKind::Gap || armed_[guard] == Arming::Not)
    return false;
  const double h = b.time - a.time;
  const double reach = h * std::max({std::abs(a.rate[guard]), std::abs(b.rate[guard]), std::abs(b.rate[guard] - a.rate[guard])});
  return std::min(a.value[guard], b.value[guard]) < reach;
}

// Gaps have rates: an interval in which one may dip is halved until the cubic through the ends predicts the middle well enough to decide.
void EventDetection::examine(const Sample &a, const Sample &b, int depth, DetectedEvent &first) {
  bool divide = false;
  for (std::size_t k = 0; k < dynamics_.guards().size(); ++k) {
    const int guard = static_cast<int>(k);
    if (depth > 0 && isForceGuard(dynamics_.guards()[k].kind))
      continue;
    if (a.value[k] > threshold(guard))
      armed_[k] = Arming::ByValue;
    if (b.value[k] < level(guard))
      bracket(guard, a, b, first);
    divide = divide || mayDip(guard, a, b);
  }
  if (!divide || depth >= deepest)
    return;
  const double h = b.time - a.time;
  Sample &middle = pool_[depth];
  if (!sampleInside(0.5 * (a.time + b.time), false, middle))
    return;
  bool again = false;
  for (std::size_t k = 0; k < dynamics_.guards().size(); ++k) {
    const int guard = static_cast<int>(k);
    if (!mayDip(guard, a, b))
      continue;
    const double error = std::abs(hermite(a.value[k], a.rate[k], b.value[k], b.rate[k], h, 0.5) - middle.value[k]);
    double place = 0;
    const double left = hermiteMinimum(a.value[k], a.rate[k], middle.value[k], middle.rate[k], 0.5 * h, place);
    const double right = hermiteMinimum(middle.value[k], middle.rate[k], b.value[k], b.rate[k], 0.5 * h, place);
    // The cubics on the halves are about sixteen times better than the one on the whole.
    again = again || middle.value[k] < 0 || std::min({left, right, middle.value[k]}) < 0.25 * error || left < 0 || right < 0;
  }
  if (!again)
    return;
  examine(a, middle, depth + 1, first);
  if (first.guard < 0 || first.time > middle.time)
    examine(middle, b, depth + 1, first);
}

// Forces, slips and conditions have no rates: the parabola through three samples shows a dip between them.
void EventDetection::examineForces(const Sample &a, const Sample &middle, const Sample &b, DetectedEvent &first) {
  const double h = b.time - a.time;
  for (std::size_t k = 0; k < dynamics_.guards().size(); ++k) {
    if (dynamics_.guards()[k].kind == GuardKind::Gap || armed_[k] == Arming::Not || middle.value[k] < 0 || b.value[k] < 0)
      continue;
    const double curvature = 2 * (a.value[k] - 2 * middle.value[k] + b.value[k]);
    const double slope = b.value[k] - a.value[k];
    if (!(curvature > 0))
      continue;
    const double s = 0.5 - slope / (2 * curvature);
    if (!(s > 0 && s < 1))
      continue;
    const double least = middle.value[k] - slope * slope / (8 * curvature);
    if (least > 0.2 * std::min({a.value[k], middle.value[k], b.value[k]}))
      continue;
    const double time = a.time + s * h;
    Sample &bottom = pool_[0];
    bottom.time = time;
    bottom.value.resize(dynamics_.guards().size());
    bottom.rate.resize(dynamics_.guards().size());
    bottom.value[k] = guardInside(static_cast<int>(k), time);
    if (bottom.value[k] < 0)
      bracket(static_cast<int>(k), time < middle.time ? a : middle, bottom, first);
  }
}

// All guards are gaps that the step cannot have closed, by their rates at both ends.
bool EventDetection::allFar() const {
  const double h = end_.time - begin_.time;
  for (std::size_t k = 0; k < armed_.size(); ++k) {
    if (dynamics_.guards()[k].kind != GuardKind::Gap || armed_[k] == Arming::Not)
      return false;
    const double a = begin_.rate[k], b = end_.rate[k];
    if (!(std::min(begin_.value[k], end_.value[k]) > 2 * h * std::max({std::abs(a), std::abs(b), std::abs(b - a)})))
      return false;
  }
  return true;
}

DetectedEvent EventDetection::detect() {
  DetectedEvent first;
  if (dynamics_.guards().empty())
    return first;
  begin_.time = integrator_->beginTime();
  // The dynamics' last evaluation is at the end of the step.
  readGuards(integrator_->endTime(), end_);
  if (allFar())
    return first;
  Sample &middle = middle_;
  if (!sampleInside(0.5 * (begin_.time + end_.time), true, middle))
    return first;
  examine(begin_, middle, 0, first);
  if (first.guard < 0 || first.time > middle.time)
    examine(middle, end_, 0, first);
  examineForces(begin_, middle, end_, first);
  return first;
}

void EventDetection::advance() {
  for (std::size_t k = 0; k < armed_.size(); ++k)
    if (end_.value[k] > threshold(static_cast<int>(k)))
      armed_[k] = Arming::ByValue;
  std::swap(begin_, end_);
  if (!watched_)
    return;
  watched_ = false;
  for (std::size_t k = 0; k < armed_.size(); ++k)
    watched_ = watched_ || (dynamics_.guards()[k].kind == GuardKind::Gap && begin_.value[k] <= 1e3 * threshold(static_cast<int>(k)));
  integrator_->setCareful(watched_);
}

// The step's length h is an unknown together with the state: Newton's method on guard(y(t0 + h)) = 0 with the element solved anew for each
// h, until h changes so little that the state moves along dy/dt (trapezoidal rule, error h³) to rounding.
bool EventDetection::locate(DetectedEvent &event) {
  const int guard = event.guard;
  const double zero = level(guard);
  const double begin = integrator_->beginTime();
  double low = begin, high = std::max(event.high, event.time);
  double x = event.time, slope = event.slope;
  for (int k = 0; k < 60; ++k) {
    if (!integrator_->shorten(x))
      return false;
    // The guard is zero where the event's state will be: on the closed contacts.
    dynamics_.project(integrator_->end(), integrator_->settings().scale.data());
    readGuards(x, end_);
    const double value = end_.value[guard] - zero;
    (value >= 0 ? low : high) = x;
    if (!std::isnan(end_.rate[guard]))
      slope = end_.rate[guard];
    const double correction = slope < 0 ? -value / slope : std::numeric_limits<double>::infinity();
    if (std::abs(correction) <= integrator_->reach() * (x - begin) && extend(guard, zero, slope, x, event))
      return true;
    if (std::abs(correction) <= 1e-5 * (x - begin))
      return nudge(guard, zero, slope, x, event);
    double next = x + correction;
    if (!(next > low && next < high)) {
      // The element's own zero may lie a little beyond the bracket that the interpolant gave.
      if (value >= 0 && x >= high - 1e-12 * (high - begin) && k < 4) {
        high = x + 0.1 * (x - begin);
        next = std::min(next, high);
      } else {
        next = 0.5 * (low + high);
      }
    }
    if (std::abs(next - x) <= std::numeric_limits<double>::epsilon() * std::abs(x)) {
      event.time = x;
      return true;
    }
    x = next;
  }
  event.time = x;
  return true;
}

bool EventDetection::findEarlier(DetectedEvent &event) {
  constexpr double visible = 100 * rounding;
  DetectedEvent earlier;
  const double begin = integrator_->beginTime();
  if (std::abs(event.time - end_.time) > 1e-3 * (event.time - begin))
    readGuards(event.time, end_);
  const double beyond = event.time - end_.time;
  for (std::size_t k = 0; k < dynamics_.guards().size(); ++k) {
    const Guard &guard = dynamics_.guards()[k];
    const int number = static_cast<int>(k);
    if (guard.kind != GuardKind::Gap || number == event.guard)
      continue;
    const double rate = end_.rate[k], value = end_.value[k] + rate * beyond - level(number);
    if (value >= -visible * guard.scale)
      continue;
    double time = rate < 0 ? event.time - value / rate : begin;
    if (!(time > begin))
      time = 0.5 * (begin + event.time);
    if (earlier.guard < 0 || time < earlier.time)
      earlier = {number, time, begin, event.time, rate};
  }
  if (earlier.guard < 0)
    return false;
  event = earlier;
  return true;
}

// From the element's end at `base`, projected, along the interpolant to the zero nearby; the rate at the end stays that at `base`. False:
// no zero within the interpolant's reach.
bool EventDetection::extend(int guard, double zero, double slope, double base, DetectedEvent &event) {
  const double farthest = integrator_->reach() * (base - integrator_->beginTime());
  const double resolution = 0.5 * std::numeric_limits<double>::epsilon() * std::max(std::abs(base), base - integrator_->beginTime());
  const int n = dynamics_.size();
  double x = base, value = end_.value[guard] - zero;
  integrator_->interpolate(base, state_.data());
  nudgeBase_.resize(n);
  for (int i = 0; i < n; ++i)
    nudgeBase_[i] = integrator_->end()[i] - state_[i];
  const bool isGap = dynamics_.guards()[guard].kind == GuardKind::Gap;
  for (int k = 0; k < 8; ++k) {
    const double next = x - value / slope;
    if (!(std::abs(next - base) <= farthest))
      return false;
    if (std::abs(next - x) <= resolution)
      break;
    const double before = value, step = next - x;
    x = next;
    integrator_->interpolate(x, state_.data());
    for (int i = 0; i < n; ++i)
      state_[i] += nudgeBase_[i];
    value = guardAt(guard, x, state_.data()) - zero;
    if (isGap)
      slope = dynamics_.model().gapRate[dynamics_.guards()[guard].index];
    else if (value != before && std::abs(step) > 8 * resolution)
      slope = (value - before) / step;
    if (!(slope < 0))
      return false;
  }
  if (x != base) {
    std::copy(state_.begin(), state_.end(), integrator_->end());
    integrator_->moveEnd(x);
  }
  event.time = x;
  return true;
}

// From the element's end at `base`, where the dynamics has been evaluated, to the zero nearby.
bool EventDetection::nudge(int guard, double zero, double slope, double base, DetectedEvent &event) {
  const int n = dynamics_.size();
  nudgeBase_.assign(integrator_->end(), integrator_->end() + n);
  nudgeRate_.assign(integrator_->endRate(), integrator_->endRate() + n);
  double value = end_.value[guard] - zero, x = base, previous = base, previousValue = value;
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
