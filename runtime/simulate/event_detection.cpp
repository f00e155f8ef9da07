#include "runtime/simulate/event_detection.h"

#include "runtime/integrate/byte_flags.h"
#include "runtime/integrate/parabola_zero.h"
#include "runtime/simulate/cubic_hermite.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// Of a gap, relative to its scale.
constexpr double rounding = 1e-12;
// The part of it that gaps of bodies not far away are off by.
constexpr double unseen = 1e-13;

constexpr int deepest = 13;  // divisions of a step in the search for a gap that dips

// By how much the i-th of equal places is moved, in parts of their distance: else whole periods of a guard might pass between them unseen.
double unevenShift(long long i) {
  constexpr double largest = 0.15;
  return largest * (2 * std::fmod(static_cast<double>(i) * goldenSection, 1.0) - 1);
}

// A value of a function of time, whose rate is not known.
struct Place {
  double time, value;
};

double leastOf(const std::array<Place, 3> &p) { return std::min({p[0].value, p[1].value, p[2].value}); }

// Of three, in their order, and another one between them: the least one and its neighbours, or the three that are nearest to it.
std::array<Place, 3> nearestToBottom(const std::array<Place, 3> &p, const Place &other) {
  const bool isEarly = other.time < p[1].time;
  const std::array<Place, 4> all = {p[0], isEarly ? other : p[1], isEarly ? p[1] : other, p[2]};
  const bool isLeft = std::min(all[0].value, all[1].value) <= std::min(all[2].value, all[3].value);
  return isLeft ? std::array{all[0], all[1], all[2]} : std::array{all[1], all[2], all[3]};
}

// Of the parabola through three of them that bends up; NaN of others.
Place bottomOfParabola(const std::array<Place, 3> &p) {
  const double left = (p[1].value - p[0].value) / (p[1].time - p[0].time), right = (p[2].value - p[1].value) / (p[2].time - p[1].time);
  const double bend = (right - left) / (p[2].time - p[0].time);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (!(bend > 0))
    return {none, none};
  const double slope = left + bend * (p[1].time - p[0].time);  // at p[1]
  return {p[1].time - slope / (2 * bend), p[1].value - slope * slope / (4 * bend)};
}

}  // namespace

EventDetection::EventDetection(ModeDynamics &dynamics)
    : dynamics_(dynamics), pool_(deepest + 1), state_(dynamics.size()), scratch_(dynamics.size()),
      boxCenter_(dynamics.model().model().nq + 1), boxRadius_(boxCenter_.size()) {}

void EventDetection::setIntegrator(SmoothIntegrator &integrator) {
  integrator_ = &integrator;
  startsToRounding_ = integrator.startsToRounding();
  error_ = integrator.startingError();
  // Forces are functions of the state, and what they are off by is no larger because the state may be: one that pulls is an error that
  // shows.
  constexpr double leastForceError = 1e-9, largestForceError = 1e-5;
  forceError_ = std::clamp(integrator.settings().tolerance, leastForceError, largestForceError);
  dynamics_.setForceError(forceError_);
}

// Magnitude below which a guard that starts at zero has not clearly left it: the integrator's error.
double EventDetection::threshold(int guard) const {
  const Guard &g = dynamics_.guards()[guard];
  return (isForceGuard(g.kind) ? forceError_ : error_) * g.scale;
}

// Where a hop begins and ends: zero, but for a gap that starts clearly below it.
double EventDetection::hopBase(int guard) const { return starts_[guard].value < -starts_[guard].rounding ? starts_[guard].value : 0; }

// What a gap differs from zero by where it is zero; `farthest` as of ContactScales. 0 for other guards.
double EventDetection::roundingOf(int guard, double farthest) const {
  const Guard &g = dynamics_.guards()[guard];
  const ModelEvaluation &model = dynamics_.model();
  return g.kind == GuardKind::Gap ? rounding * std::max(g.scale, model.scales.gap(g.index, model.coordinates(), farthest)) : 0;
}

// The value below which the guard has ended the mode: one that starts at zero, or below it by the integrator's error, must fall further.
double EventDetection::level(int guard) const {
  switch (starts_[guard].armed) {
  case Arming::ByValue:
    return 0;
  case Arming::BySpeed:
    // Without the integral of the rate (see hop) a gap that grows is below zero by rounding at first.
    return hopBase(guard) - (startsToRounding_ ? 0 : unseen * dynamics_.guards()[guard].scale);
  case Arming::Not:
    break;
  }
  return std::min(starts_[guard].value, 0.0) - threshold(guard);
}

// A gap that leaves zero at a tiny speed returns before it can be told from rounding; the integral of its rate (trapezoidal rule, exact for
// a ballistic hop) shows it all the same. Of higher hops the gap is the more exact one.
double EventDetection::hop(int guard, double time, double gap, double rate) const {
  const Start &start = starts_[guard];
  const double lowest = start.rounding, base = hopBase(guard);
  if (!startsToRounding_ || start.value > lowest || std::abs(gap - base) > lowest)
    return gap;
  const double duration = time - start.time, integral = 0.5 * duration * (start.rate + rate);
  const double height = rate < 0 && start.rate > 0 ? 0.5 * duration * start.rate * start.rate / (start.rate - rate) : integral;
  return std::abs(height) <= lowest && std::abs(integral) <= 10 * lowest ? base + integral : gap;
}

void EventDetection::arm(int guard) {
  if (starts_[guard].armed == Arming::ByValue)
    return;
  armedNow_.emplace_back(guard, starts_[guard].armed);
  starts_[guard].armed = Arming::ByValue;
}

bool EventDetection::isArmedNow(int guard) const {
  return std::any_of(armedNow_.begin(), armedNow_.end(), [guard](const auto &other) { return other.first == guard; });
}

void EventDetection::readGuards(double time, Sample &sample) {
  sample.time = time;
  sample.value.resize(dynamics_.guards().size());
  sample.rate.resize(dynamics_.guards().size());
  dynamics_.guardValues(awake_, sample.value.data(), sample.rate.data());
  for (const int k : awake_)
    if (dynamics_.guards()[k].kind == GuardKind::Gap)
      sample.value[k] = hop(k, time, sample.value[k], sample.rate[k]);
}

double EventDetection::stepAside(double time, const double *state, const double *rate) {
  // Far from zero times are not resolved better.
  static const double least = std::sqrt(std::numeric_limits<double>::epsilon());
  constexpr double resolved = 1e5 * std::numeric_limits<double>::epsilon();
  double increment = least;
  if (const double shift = resolved * std::abs(time); shift > least)
    increment = (time + shift) - time;
  for (int i = 0; i < dynamics_.size(); ++i)
    state_[i] = state[i] + increment * rate[i];
  dynamics_.model().setPoint(time + increment, state_.data());
  return increment;
}

// Where the dynamics has been evaluated last, at the end of the integrator's step.
void EventDetection::readEnd(Sample &sample) {
  const double time = integrator_->endTime(), *state = integrator_->end();
  if (!hasDifferences_) {
    readGuards(time, sample);
    return readSlipRates(sample);
  }
  const double increment = stepAside(time, state, integrator_->endRate());
  readGuards(time + increment, shifted_);
  dynamics_.model().setPoint(time, state);
  readGuards(time, sample);
  for (const int k : awake_)
    if (hasRateByDifference(dynamics_.guards()[k].kind))
      sample.rate[k] = (shifted_.value[k] - sample.value[k]) / increment;
  readSlipRates(sample);
}

// Of one component, by the accelerations of the dynamics' last evaluation.
void EventDetection::readSlipRates(Sample &sample) {
  for (const int k : awake_)
    if (dynamics_.guards()[k].kind == GuardKind::Slip)
      sample.rate[k] = dynamics_.slipRate(k);
}

void EventDetection::interpolate(double time) {
  if (fromEnds_)
    integrator_->interpolateEnds(time, state_.data());
  else
    integrator_->interpolate(time, state_.data());
}

bool EventDetection::sampleInside(double time, bool withForces, Sample &sample) {
  if (needsRates_) {
    const double shift = time + probeStep_;
    interpolate(shift);
    dynamics_.model().setPoint(shift, state_.data());
    readGuards(shift, shifted_);
  }
  interpolate(time);
  if (!withForces)
    dynamics_.model().setPoint(time, state_.data());
  else if (!dynamics_.evaluate(time, state_.data(), scratch_.data()))
    return false;
  readGuards(time, sample);
  if (needsRates_)
    for (const int k : awake_)
      if (hasRateByDifference(dynamics_.guards()[k].kind))
        sample.rate[k] = (shifted_.value[k] - sample.value[k]) / probeStep_;
  for (const int k : awake_)
    fastest_[k] = std::max(fastest_[k], std::abs(sample.rate[k]));
  if (needsForces_ && !withForces)
    for (const int k : awake_)
      if (isForceGuard(dynamics_.guards()[k].kind))
        sample.value[k] = std::numeric_limits<double>::quiet_NaN();
  return true;
}

double EventDetection::guardAt(int guard, double time, const double *state) {
  const bool isForce = isForceGuard(dynamics_.guards()[guard].kind);
  if (isForce && !dynamics_.evaluate(time, state, scratch_.data()))
    return std::numeric_limits<double>::quiet_NaN();
  if (!isForce)
    dynamics_.model().setPoint(time, state);
  return guardHere(guard, time);
}

// At the dynamics' point.
double EventDetection::guardHere(int guard, double time) {
  const double value = dynamics_.guardValue(guard);
  const Guard &g = dynamics_.guards()[guard];
  return g.kind == GuardKind::Gap ? hop(guard, time, value, dynamics_.model().gapRate[g.index]) : value;
}

double EventDetection::guardInside(int guard, double time) {
  interpolate(time);
  return guardAt(guard, time, state_.data());
}

// Guards are read as they are: what has been remembered of them belongs to another mode, or to another begin of this one.
void EventDetection::restart(double time, double partOfRounding) {
  starts_.assign(dynamics_.guards().size(), openStart(time));
  readStarts(time, partOfRounding);
}

void EventDetection::readStarts(double time, double partOfRounding) {
  const std::vector<Guard> &guards = dynamics_.guards();
  needsForces_ = hasDifferences_ = false;
  for (std::size_t k = dynamics_.gapGuardCount(); k < guards.size(); ++k) {
    needsForces_ = needsForces_ || isForceGuard(guards[k].kind);
    hasDifferences_ = hasDifferences_ || hasRateByDifferenceAtEnds(guards[k].kind);
  }
  varies_ = dynamics_.guardsVary();
  cut_ = false;
  // A gap whose reading leaves the screen's box wakes contacts.
  do {
    chooseAwake();
    readGuards(time, begin_);
  } while (!isCurrent());
  for (const int k : held_)
    starts_[k] = {Arming::Not, time, dynamics_.guardValue(k), 0, 0};
  const double farthest = dynamics_.model().scales.farthest(dynamics_.model().coordinates());
  // A gap that opens at a speed needs no distance to be taken for open.
  for (const int k : awake_) {
    const double least = threshold(k);
    const bool opens = dynamics_.guards()[k].kind == GuardKind::Gap && opensAtSpeed(k, partOfRounding);
    const Arming armed = begin_.value[k] > least ? Arming::ByValue : opens ? Arming::BySpeed : Arming::Not;
    starts_[k] = {armed, time, begin_.value[k], begin_.rate[k], roundingOf(k, farthest)};
  }
}

bool EventDetection::opensAtSpeed(int guard, double partOfRounding) const {
  const ModelEvaluation &model = dynamics_.model();
  const double scale = model.scales.gapRate(dynamics_.guards()[guard].index, model.velocities());
  return startsToRounding_ ? begin_.rate[guard] > partOfRounding * scale
                           : begin_.rate[guard] > 1e3 * error_ * scale && begin_.value[guard] > -1e-3 * threshold(guard);
}

bool EventDetection::isCurrent() const { return awakeRevision_ == dynamics_.model().screen().revision(); }

// Guards of contacts that are asleep have no zeros.
void EventDetection::chooseAwake() {
  const GapScreen &screen = dynamics_.model().screen();
  awakeRevision_ = screen.revision();
  awake_.clear();
  const std::vector<std::uint8_t> &closed = dynamics_.mode().closed;
  int closedBefore = 0;  // closed contacts are awake
  forEachSet(screen.awake(), static_cast<int>(closed.size()), [&](int contact) {
    if (closed[contact] != 0)
      ++closedBefore;
    else
      awake_.push_back(contact - closedBefore);
  });
  held_.clear();
  for (int k = dynamics_.gapGuardCount(); k < static_cast<int>(dynamics_.guards().size()); ++k)
    (dynamics_.guards()[k].isHeld ? held_ : awake_).push_back(k);
}

// The hull of the cubic through both ends of the step in each coordinate, and a part `reach` of it on either side, is kept by the screen;
// in the end all contacts are awake.
void EventDetection::coverStep(double reach) {
  const SmoothIntegrator &step = *integrator_;
  ModelEvaluation &model = dynamics_.model();
  const int nq = model.model().nq;
  constexpr double farthest = 100;
  const double h = step.endTime() - step.beginTime();
  for (int k = 0; k < nq; ++k) {
    const double a = step.begin()[k], b = integrator_->end()[k], da = step.beginRate()[k], db = integrator_->endRate()[k];
    const double low = std::min({a, b, CubicHermite{a, da, b, db, h}.interiorMinimum()});
    const double high = std::max({a, b, -CubicHermite{-a, -da, -b, -db, h}.interiorMinimum()});
    boxCenter_[k] = 0.5 * (low + high);
    boxRadius_[k] = (0.5 + reach) * (high - low);
  }
  boxCenter_[nq] = step.beginTime() + 0.5 * h;
  boxRadius_[nq] = 0.5 * h;
  if (reach > farthest)
    std::fill(boxRadius_.begin(), boxRadius_.end(), std::numeric_limits<double>::infinity());
  model.cover(boxCenter_.data(), boxRadius_.data(), step.beginRate());
}

// Contacts that have woken were open at the begin of the step.
void EventDetection::wake() {
  ModelEvaluation &model = dynamics_.model();
  const double begin = integrator_->beginTime();
  previous_.swap(awake_);
  chooseAwake();
  model.setPoint(begin, integrator_->begin());
  for (const int k : awake_) {
    if (std::binary_search(previous_.begin(), previous_.end(), k))
      continue;
    starts_[k] = openStart(begin);
    begin_.value[k] = guardHere(k, begin);
    begin_.rate[k] = model.gapRate[dynamics_.guards()[k].index];
  }
}

// Gaps are the first guards of a mode, and the same ones with any choice of directions and forces.
void EventDetection::resume(double time, double partOfRounding) {
  resumed_ = starts_;
  previous_.swap(awake_);
  starts_.resize(dynamics_.guards().size(), openStart(time));
  readStarts(time, partOfRounding);
  for (const int k : awake_)
    if (k < dynamics_.gapGuardCount())
      starts_[k] = std::binary_search(previous_.begin(), previous_.end(), k) ? resumed_[k] : openStart(time);
}

void EventDetection::watchStart() {
  if (hasDifferences_)
    readEnd(begin_);
  else
    readSlipRates(begin_);
  watchZeros(1);
}

// Gaps and slips which are within so many times their thresholds.
void EventDetection::watchZeros(double factor) {
  const auto isWatched = [&](int k) {
    const Guard &guard = dynamics_.guards()[k];
    return (guard.kind == GuardKind::Gap || guard.kind == GuardKind::Slip) && begin_.value[k] <= factor * threshold(k);
  };
  watched_ = std::any_of(awake_.begin(), awake_.end(), isWatched);
  integrator_->setCareful(watched_);
}

// A guard that may come near zero between the samples: its own rates could take it there, here or elsewhere in the step, as both samples
// may be crests of one that oscillates. A gap that starts at its zero, as right before an impact, may fall from there and have returned.
bool EventDetection::mayDip(int guard, const Sample &a, const Sample &b) const {
  const GuardKind kind = dynamics_.guards()[guard].kind;
  const bool isOpen = starts_[guard].armed != Arming::Not, closes = kind == GuardKind::Gap && starts_[guard].rate < 0;
  if (!hasRate(kind) || !(isOpen || closes))
    return false;
  const double reach = (b.time - a.time) * std::max(fastest_[guard], std::abs(b.rate[guard] - a.rate[guard]));
  return std::min(a.value[guard], b.value[guard]) - level(guard) < reach;
}

// Zeros between two samples, of all guards (or of those with rates, where the samples inside a larger interval have no others), and which
// of these may dip between. True: one may.
bool EventDetection::examineEnds(const Sample &a, const Sample &b, bool withForces, DetectedEvent &first) {
  bool dips = false;
  for (const int k : awake_) {
    if ((!withForces && isForceGuard(dynamics_.guards()[k].kind)) || isSampled(k))
      continue;
    if (a.value[k] > threshold(k))
      arm(k);
    if (b.value[k] < level(k))
      bracket(k, a, b, first);
    dips = dips || mayDip(k, a, b);
  }
  return dips;
}

void EventDetection::forgetMisfits(Sample &middle) const {
  middle.misfit.resize(middle.value.size());
  for (const int k : awake_)
    middle.misfit[k] = std::numeric_limits<double>::infinity();
}

// Whether a guard that may dip is not clearly positive between the samples: the cubic through the ends must predict the middle well enough.
// `coarser`: the middle of the interval that this one is a part of, or null.
bool EventDetection::isUnclear(int guard, const Sample &a, Sample &middle, const Sample &b, const Sample *coarser) const {
  // Of the reach of the rates. What is not resolved, as a wheel with many teeth, fits as well as this hardly by chance; less well it must
  // fit twice.
  constexpr double fitting = 1e-3, resolved = 0.02;
  constexpr double decay = 0.1;  // of the misfit with a division, 0.54⁴
  const double h = b.time - a.time, zero = level(guard), rate = middle.rate[guard];
  const double begin = a.value[guard] - zero, value = middle.value[guard] - zero, end = b.value[guard] - zero;
  // The value there may fit by chance, not its rate as well.
  const CubicHermite whole{begin, a.rate[guard], end, b.rate[guard], h};
  const double place = (middle.time - a.time) / h;
  const double ofValue = std::abs(whole.value(place) - value), ofSlope = std::abs(whole.slope(place) - h * rate);
  const double own = std::max(ofValue, 0.25 * ofSlope);
  const double before = coarser != nullptr ? coarser->misfit[guard] : std::numeric_limits<double>::infinity();
  const double reach = h * std::max({std::abs(a.rate[guard]), std::abs(rate), std::abs(b.rate[guard])});
  const bool isFirst = !std::isfinite(before);
  middle.misfit[guard] = isFirst ? own : std::max(own, decay * before);
  const bool fits = isFirst ? std::max(ofValue, 0.5 * ofSlope) <= fitting * reach : own <= resolved * reach;
  if (!fits)
    return true;
  // What is so much better than before is so by chance.
  double error = !isFirst && own < 0.2 * decay * before ? before : middle.misfit[guard];
  if (fromEnds_)
    error = std::max(error, endsError_[guard]);
  const double left = CubicHermite{begin, a.rate[guard], value, rate, middle.time - a.time}.interiorMinimum();
  const double right = CubicHermite{value, rate, end, b.rate[guard], b.time - middle.time}.interiorMinimum();
  // The cubics on the parts are about sixteen times better than the one on the whole, but for gaps with a bend, as that of a narrow post.
  return value < 0 || std::min({left, right, value}) < 4 * error || left < 0 || right < 0;
}

// An interval in which a guard with a rate may dip is divided until it is clear whether it does.
void EventDetection::examine(const Sample &a, const Sample &b, int depth, DetectedEvent &first) {
  const bool divide = examineEnds(a, b, depth == 0, first);
  if (!divide || depth >= deepest || (first.guard >= 0 && first.time <= a.time))
    return;
  Sample &middle = pool_[depth];
  if (!sampleInside(a.time + unevenPart * (b.time - a.time), false, middle))
    return;
  forgetMisfits(middle);
  const Sample *coarser = depth > 0 ? &pool_[depth - 1] : nullptr;
  const auto isOpen = [&](int k) { return !isSampled(k) && mayDip(k, a, b) && isUnclear(k, a, middle, b, coarser); };
  if (std::none_of(awake_.begin(), awake_.end(), isOpen))
    return;
  examine(a, middle, depth + 1, first);
  if (first.guard < 0 || first.time > middle.time)
    examine(middle, b, depth + 1, first);
}

// Forces have no rates.
void EventDetection::examineForces(const Sample &a, const Sample &middle, const Sample &b, DetectedEvent &first) {
  for (const int k : awake_)
    if (isForceGuard(dynamics_.guards()[k].kind) && !isSampled(k) && starts_[k].armed != Arming::Not && middle.value[k] >= 0 &&
        b.value[k] >= 0)
      examineDip(k, a, middle, b, first);
}

// A force that is positive at three samples, between them: at the bottom of the parabola through them, and of those through what is found
// there, until it is negative or clear of zero. Where a stage of the method has met less than all samples, that is one of the three.
void EventDetection::examineDip(int guard, const Sample &a, const Sample &middle, const Sample &b, DetectedEvent &first) {
  constexpr int mostSamples = 8;
  constexpr double clear = 0.2, resolved = 1e-3;
  std::array<Place, 3> p = {Place{a.time, a.value[guard]}, Place{middle.time, middle.value[guard]}, Place{b.time, b.value[guard]}};
  if (dynamics_.guards()[guard].kind == GuardKind::Force && integrator_->samplesInside()) {
    const Place least{dynamics_.leastMarginTime(guard), dynamics_.leastMargin(guard)};
    if (least.time > a.time && least.time < b.time && least.value < leastOf(p))
      p = nearestToBottom(p, least);
  }
  for (int k = 0; k < mostSamples; ++k) {
    const Place bottom = bottomOfParabola(p);
    const bool isInside = bottom.time > p[0].time && bottom.time < p[2].time;
    if (!isInside || bottom.value > clear * leastOf(p) || (first.guard >= 0 && bottom.time >= first.time))
      return;
    const double length = p[2].time - p[0].time;
    if (k > 0 && std::any_of(p.begin(), p.end(), [&](const Place &x) { return std::abs(bottom.time - x.time) <= resolved * length; }))
      return;
    const Place found{bottom.time, guardInside(guard, bottom.time)};
    if (found.value < 0) {
      const Sample &before = found.time < middle.time ? a : middle;
      bracketProbes(guard, {before.time, before.value[guard], 0}, {found.time, found.value, 0}, first);
    }
    if (!(found.value >= 0))
      return;
    p = nearestToBottom(p, found);
  }
}

// Functions of angles must not turn round unseen between two samples.
// What a gap or condition has at a place only is at least so wide, in nominal magnitudes of the coordinates.
double EventDetection::farthestTurn() const {
  constexpr double ofPlaces = 1.0 / 64;
  const tf_model &model = dynamics_.model().model();
  return (model.locality & TF_LOCAL_GUARDS) != 0 ? ofPlaces : model.nr > 0 ? 0.5 : 1;  // quaternions turn by half of the angle
}

// Rates beyond all measure; or coordinates whose nominal magnitudes say nothing of the places that matter.
double EventDetection::mostIntervals() const { return (dynamics_.model().model().locality & TF_LOCAL_GUARDS) != 0 ? 4096 : 1e15; }

// Into so many parts the step is divided at least, nearly equal ones.
long long EventDetection::intervalCount() const {
  const double most = mostIntervals();
  const tf_model &model = dynamics_.model().model();
  const double h = end_.time - begin_.time;
  double turn = 0;
  for (int i = 0; i < model.nq; ++i)
    turn = std::max(turn, std::max(std::abs(integrator_->beginRate()[i]), std::abs(integrator_->endRate()[i])) /
                              integrator_->settings().scale[i]);
  return std::max(2LL, static_cast<long long>(std::min(std::ceil(h * turn / farthestTurn()), most)));
}

// Where the i-th sample, the one behind that at `time`, is due in a step of uniform motion: as far away as the rates there let it be, at
// the begin of a long fall farther than at its end.
double EventDetection::nextUniformSample(double time, long long number) const {
  const tf_model &model = dynamics_.model().model();
  const double *begin = integrator_->beginRate(), *end = integrator_->endRate();
  const double length = end_.time - begin_.time, passed = (time - begin_.time) / length;
  double distance = 0.5 * length;
  for (int i = 0; i < model.nq; ++i) {
    const double turn = farthestTurn() * integrator_->settings().scale[i];
    const double rate = std::abs(begin[i] + passed * (end[i] - begin[i])), acceleration = std::abs(end[i] - begin[i]) / length;
    distance = std::min(distance, parabolaZero(turn, -rate, -acceleration));
  }
  return time + std::max((1 + unevenShift(number)) * distance, length / mostIntervals());
}

DetectedEvent EventDetection::detect() {
  cut_ = cut_ && integrator_->endTime() == cutTime_;
  searchedTo_ = integrator_->endTime();
  if (dynamics_.guards().empty())
    return {};
  begin_.time = integrator_->beginTime();
  // Where an interpolant leaves what the rates at the ends let expect, other contacts wake.
  if (!dynamics_.model().screen().isUsed())
    return search();
  for (double reach = 0.1;; reach *= 4) {
    coverStep(reach);
    if (!isCurrent())
      wake();
    dynamics_.model().setPoint(integrator_->endTime(), integrator_->end());
    const DetectedEvent first = search();
    if (isCurrent())
      return first;
    dynamics_.evaluate(integrator_->endTime(), integrator_->end(), scratch_.data());
  }
}

// They are zero at the ends of steps, unless they leave it for good.
void EventDetection::examineHeld(DetectedEvent &first) {
  dynamics_.model().setPoint(integrator_->endTime(), integrator_->end());
  for (const int k : held_)
    if (first.guard < 0 && dynamics_.guardValue(k) < level(k))
      first = {k, end_.time, begin_.time, end_.time, 0};
}

DetectedEvent EventDetection::search() {
  DetectedEvent first;
  first_.time = std::numeric_limits<double>::quiet_NaN();
  armedNow_.clear();
  // The dynamics' last evaluation is at the end of the step.
  readEnd(end_);
  samplesVarying_ = samplesVarying();
  fastest_.resize(end_.rate.size());
  bool quiet = true, steady = true;
  needsRates_ = false;
  for (const int k : awake_) {
    fastest_[k] = std::max(std::abs(begin_.rate[k]), std::abs(end_.rate[k]));
    if (isSampled(k))
      continue;
    const GuardKind kind = dynamics_.guards()[k].kind;
    if (kind == GuardKind::Force)
      steady = steady && isSteady(k);
    else if (isForceGuard(kind))
      steady = false;
    else if (!isFar(k)) {
      quiet = false;
      needsRates_ = needsRates_ || hasRateByDifference(kind);
    }
  }
  // Differences in too short a step would be rounding; it has no room for a dip.
  needsRates_ = needsRates_ && 100 * probeStep_ <= end_.time - begin_.time;
  // Long steps may turn a body round: their ends tell nothing.
  quiet = quiet && (!integrator_->isExactInside() || intervalCount() == 2);
  if (!(quiet && steady) && !examineCubics(first)) {
    first = {};
    if (!(steady && examineEndsAlone(first)))
      examineSamples(!steady, first);
  }
  if (samplesVarying_)
    examineVarying(first);
  if (first.guard >= 0 && searchedTo_ < end_.time && first.time > searchedTo_)
    first = {};
  if (!held_.empty() && first.guard < 0)
    examineHeld(first);
  // The step is to end with this guard: where the others have been positive may be later.
  if (first.guard >= 0)
    disarm([&first](int k) { return k != first.guard; });
  return first;
}

void EventDetection::examineSamples(bool withForces, DetectedEvent &first) {
  const bool isUniform = integrator_->isUniform();
  const long long count = isUniform ? 0 : intervalCount();
  const double h = end_.time - begin_.time;
  const Sample *before = nullptr, *a = &begin_;
  for (long long i = 1; a != &end_ && (first.guard < 0 || first.time > a->time); ++i) {
    const double time = isUniform   ? nextUniformSample(a->time, i)
                        : i < count ? begin_.time + (static_cast<double>(i) + unevenShift(i)) * (h / static_cast<double>(count))
                                    : end_.time;
    const Sample *b = &end_;
    // Rates beyond all measure leave no time between two samples.
    if (time > a->time && time < end_.time) {
      Sample &inner = inner_[static_cast<std::size_t>(i % 3)];
      if (!sampleInside(time, withForces, inner))
        return;
      b = &inner;
    }
    examine(*a, *b, 0, first);
    if (before != nullptr)
      examineForces(*before, *a, *b, first);
    before = a;
    a = b;
  }
}

bool EventDetection::hasUndefined() const {
  return std::any_of(awake_.begin(), awake_.end(), [this](int k) { return std::isnan(end_.value[k]); });
}

void EventDetection::advance() {
  for (const int k : awake_)
    if (end_.value[k] > threshold(k))
      starts_[k].armed = Arming::ByValue;
  std::swap(begin_, end_);
  if (watched_)
    watchZeros(1e3);
}

}  // namespace tf::runtime
