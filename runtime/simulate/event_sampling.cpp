// Zeros of guards that vary with time or inputs beside the state, as the slip on a belt that shakes: the step's error does not tell how
// often they change their sign inside it. Samples on the interpolant do, with their rates: an interval is divided until the cubic through
// its ends predicts what is found inside.
#include "runtime/simulate/event_detection.h"

#include "runtime/simulate/cubic_hermite.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

const std::vector<double> twoParts = {unevenPart, 0.8090169943749475};
// Of steps over a time of rest, which may be all of the run: none of what lasts a twentieth of it is passed over.
const std::vector<double> &manyParts() {
  constexpr int count = 64;
  static const std::vector<double> parts = [] {
    std::vector<double> all(count);
    for (int k = 0; k < count; ++k)
      all[k] = std::fmod((k + 1) * goldenSection, 1.0);
    std::sort(all.begin(), all.end());
    return all;
  }();
  return parts;
}
// Divisions: the smallest intervals are some 1e-8 of the step.
constexpr int deepest = 30;
// Divisions for one guard in one step. A guard that takes more oscillates too often for the step, or stays at zero but for the errors of
// the interpolant: then it has led to no more than this part of the step, or changes by less than the tolerance where it is divided.
constexpr int mostDivisions = 100000;
// Of a force, which moves what the step follows: it does not oscillate often in one, and each of its values is a contact problem's
// solution.
constexpr int mostForceDivisions = 2000;
constexpr double noProgress = 1e-4;
// Forces of contacts that nearly determine one another, as in a jam, are those of rounding: they scatter by as much in however short an
// interval. Four divisions leave less than this part of what they scatter by otherwise. So do oscillations, which need as many divisions
// as it takes to come to a period; but a difference over a time that is far shorter shows no more than a small part of an oscillation.
constexpr double noisy = 0.1, rough = 0.02;
// Differences for the rates, in parts of the step; times that differ by less are not told apart well enough.
constexpr double difference = 1e-6, roundingOfTimes = 4096 * std::numeric_limits<double>::epsilon();

// What differs from the cubic by no more than `error` falls through zero once, where the cubic does, from above or from a hop.
bool fallsOnce(const CubicHermite &cubic, double zero, double error) {
  const CubicHermite above{std::max(cubic.begin - zero, 0.0), cubic.beginSlope, cubic.end - zero, cubic.endSlope, cubic.length};
  const double place = cubic.endSlope < 0 ? above.lastZero() : -1;
  if (!(place > 0) || !(-above.slope(place) >= 8 * error))
    return false;
  return above.begin >= 4 * error || above.length * above.beginSlope * place >= 16 * error;
}

}  // namespace

// On the interpolant; rates of all but gaps by differences towards the inside of the step.
EventDetection::Probe EventDetection::probe(int guard, double time) {
  Probe result{time, guardInside(guard, time), 0};
  if (const Guard &g = dynamics_.guards()[guard]; g.kind == GuardKind::Gap) {
    result.rate = dynamics_.model().gapRate[g.index];
    return result;
  }
  const double step = time + probeStep_ <= integrator_->endTime() ? probeStep_ : -probeStep_;
  result.rate = (guardInside(guard, time + step) - result.value) / step;
  return result;
}

// The step's error tells nothing of forces where nothing moves, or moves as if there were none.
bool EventDetection::isBlindStep() const {
  if (integrator_->isExactInside())
    return true;
  const tf_model &model = dynamics_.model().model();
  const IntegratorSettings &settings = integrator_->settings();
  for (int k = 0; k < model.nq + model.nv; ++k)
    if (std::abs(integrator_->end()[k] - integrator_->begin()[k]) > settings.tolerance * settings.scale[k])
      return false;
  return true;
}

// All guards at places inside the step, those of forces at two of them with their rates. False: they cannot be evaluated there.
bool EventDetection::readInside() {
  const std::vector<double> &parts = isBlindStep() ? manyParts() : twoParts;
  const std::size_t count = parts.size();
  inside_.resize(count);
  for (std::size_t place = 0; place < count; ++place) {
    Sample &sample = inside_[place];
    const double time = begin_.time + parts[place] * (end_.time - begin_.time);
    const auto read = [&](double at, Sample &into) {
      interpolate(at);
      const bool isGood = dynamics_.evaluate(at, state_.data(), scratch_.data());
      if (isGood)
        readGuards(at, into);
      return isGood;
    };
    const bool hasRate = count == 2 || place == count / 2 || place == count - count / 5;
    if ((hasRate && !read(time + probeStep_, shifted_)) || !read(time, sample))
      return false;
    for (const int k : awake_)
      if (isForceGuard(dynamics_.guards()[k].kind))
        sample.rate[k] = hasRate ? (shifted_.value[k] - sample.value[k]) / probeStep_ : 0;
  }
  return true;
}

// Of a force, where all have been read inside: whether its values and rates there, and its values at the stages of the method, show that it
// hardly changes. One that oscillates may have the same value at the begin, the end and a few stages of a long step, but hardly rates near
// zero as well.
bool EventDetection::isSteadyForce(int guard) {
  constexpr double small = 0.2;
  double least = std::min(begin_.value[guard], end_.value[guard]), most = std::max(begin_.value[guard], end_.value[guard]), rate = 0;
  const auto include = [&](double low, double high) {
    least = std::min(least, low);
    most = std::max(most, high);
  };
  if (dynamics_.guards()[guard].kind == GuardKind::Force && integrator_->samplesInside())
    include(dynamics_.leastMargin(guard), dynamics_.largestMargin(guard));
  for (const Sample &sample : inside_) {
    include(sample.value[guard], sample.value[guard]);
    rate = std::max(rate, std::abs(sample.rate[guard]));
  }
  return starts_[guard].armed != Arming::Not && least > 0 && most - least <= small * least &&
         rate * (end_.time - begin_.time) <= small * least;
}

// So short a step that rates cannot be told resolves all that varies.
bool EventDetection::samplesVarying() {
  const double h = end_.time - begin_.time;
  probeStep_ = std::max(difference * h, roundingOfTimes * std::abs(end_.time));
  return varies_ && 100 * probeStep_ <= h;
}

// Where the search for a zero of a force begins anew: what has been read inside the step may be a dip that the cubic through its ends has
// nothing of. Around the first place where the force is negative, else around the least.
std::vector<double> EventDetection::cutsOfForce(int guard) {
  std::vector<std::pair<double, double>> places = {{begin_.time, begin_.value[guard]}, {end_.time, end_.value[guard]}};
  for (const Sample &sample : inside_)
    places.emplace_back(sample.time, sample.value[guard]);
  if (dynamics_.guards()[guard].kind == GuardKind::Force && integrator_->samplesInside())
    if (const double time = dynamics_.leastMarginTime(guard); time > begin_.time && time < end_.time)
      places.emplace_back(time, dynamics_.leastMargin(guard));
  std::sort(places.begin(), places.end());
  auto lowest = std::find_if(places.begin() + 1, places.end(), [](const auto &place) { return place.second < 0; });
  if (lowest == places.end())
    lowest = std::min_element(places.begin(), places.end(), [](const auto &a, const auto &b) { return a.second < b.second; });
  std::vector<double> cuts;
  for (auto place = lowest == places.begin() ? lowest : lowest - 1; place != places.end() && place <= lowest + 1; ++place)
    if (place->first > begin_.time && place->first < end_.time)
      cuts.push_back(place->first);
  return cuts;
}

void EventDetection::examineVarying(DetectedEvent &first) {
  const auto isForce = [this](int k) { return dynamics_.guards()[k].varies && isForceGuard(dynamics_.guards()[k].kind); };
  const bool hasInside = std::any_of(awake_.begin(), awake_.end(), isForce) && readInside();
  for (const int guard : awake_) {
    const Guard &described = dynamics_.guards()[guard];
    if (!described.varies || (hasInside && isForceGuard(described.kind) && isSteadyForce(guard)))
      continue;
    DetectedEvent own;
    divisions_ = 0;
    wasPositive_ = starts_[guard].armed != Arming::Not;
    rises_ = false;
    limit_ = first.guard >= 0 ? first.time : std::numeric_limits<double>::infinity();
    const Probe a = probe(guard, begin_.time), b = probe(guard, end_.time);
    Probe low = a;
    for (const double cut : hasInside &&isForceGuard(described.kind) ? cutsOfForce(guard) : std::vector<double>()) {
      const Probe high = probe(guard, cut);
      if (own.guard < 0 && low.time < limit_)
        divide(guard, low, high, Fit{}, 0, own);
      low = high;
    }
    if (own.guard < 0 && low.time < limit_)
      divide(guard, low, b, Fit{}, 0, own);
    // It falls from its start, which is a zero, not only by the interpolant's error there.
    if (own.guard < 0 && a.value <= threshold(guard) && a.rate < 0 && b.value < level(guard))
      bracketProbes(guard, a, b, own);
    // What closed contacts correct at the end of a step is not in the interpolant.
    if (const double value = end_.value[guard] - level(guard), rate = end_.rate[guard];
        own.guard < 0 && described.kind == GuardKind::Gap && value < 0 && rate < 0)
      own = {guard, std::max(end_.time - value / rate, 0.5 * (begin_.time + end_.time)), begin_.time, end_.time, rate};
    if (own.guard >= 0 && (first.guard < 0 || own.time < first.time))
      first = own;
  }
}

// The first zero between two samples. `coarser`: of the interval that this one is a part of.
void EventDetection::divide(int guard, const Probe &a, const Probe &b, const Fit &coarser, int depth, DetectedEvent &first) {
  const double h = b.time - a.time;
  const CubicHermite whole{a.value, a.rate, b.value, b.rate, h};
  const Probe inside = probe(guard, a.time + unevenPart * h);
  const double misfit = std::max(std::abs(whole.value(unevenPart) - inside.value), std::abs(whole.slope(unevenPart) - h * inside.rate));
  if (!std::isfinite(misfit))
    return;
  // Cubics on the parts have at most 0.54⁴ of the error of the one on the whole, which has as much of the one before: what is not resolved
  // fits by chance, but not twice, and not to a part of what the rates could do.
  const double error = std::max(0.3 * misfit, 0.1 * coarser.misfit);
  const double reach = h * std::max({std::abs(a.rate), std::abs(inside.rate), std::abs(b.rate)});
  const bool isResolved = misfit <= 0.02 * reach;
  Fit fit = coarser;
  fit.misfit = misfit;
  std::rotate(fit.scatter.begin(), fit.scatter.begin() + 1, fit.scatter.end());
  fit.scatter.back() = std::abs(inside.value - a.value - unevenPart * (b.value - a.value));
  const auto middle = fit.scatter.begin() + fit.scatter.size() / 2;
  const double scatter = *std::max_element(middle, fit.scatter.end());
  const bool isForce = isForceGuard(dynamics_.guards()[guard].kind),
             isNoise =
                 isForce && scatter > noisy * *std::max_element(fit.scatter.begin(), middle) && reach * probeStep_ > rough * scatter * h;
  const bool areEnough = depth < deepest && ++divisions_ > (isForce ? mostForceDivisions : mostDivisions),
             isFinest = depth >= deepest || areEnough;
  const double leave = threshold(guard);
  rises_ = rises_ || std::max(a.value, inside.value) > leave;
  for (const auto &[low, high] : {std::pair{&a, &inside}, std::pair{&inside, &b}}) {
    if (low->time >= limit_)
      return;
    const CubicHermite part{low->value, low->rate, high->value, high->rate, high->time - low->time};
    const double interior = part.interiorMinimum(), lowest = std::min({low->value, high->value, interior});
    // What comes later says nothing about the guard's start.
    if (low->value > leave)
      arm(guard);
    const double zero = level(guard);
    // From a zero the guard must rise.
    const double least = std::abs(low->value) <= leave && low->rate > 0 ? part.leastSecant() : lowest - zero;
    if ((isResolved && least > error) || lowest - zero > 5 * (reach + misfit) ||
        (isNoise && std::min(low->value, high->value) - zero > 2 * scatter))
      continue;
    const double searched = low->time - begin_.time;
    const bool oscillates = reach > integrator_->settings().tolerance * dynamics_.guards()[guard].scale;
    if (areEnough && oscillates && searched > noProgress * (end_.time - begin_.time)) {
      limit_ = low->time;
      searchedTo_ = std::min(searchedTo_, begin_.time + 0.5 * searched);
      return;
    }
    // Below zero, if the guard has been positive, as it may have been before the step, which may begin within rounding of the zero; else
    // clearly.
    const bool comesFromAbove = (zero < 0 && !rises_) || low->value > leave || wasPositive_;
    const bool falls = high->value < zero && (comesFromAbove || high->value < -leave);
    const bool isExact = isResolved && error <= 0.1 * std::max(std::abs(low->value), std::abs(high->value));
    const bool isPositive = low->value - zero > 0.1 * part.length * low->rate && !(interior < zero);
    // A gap that opens at a speed and has returned, from however low a hop.
    const bool isHop = starts_[guard].armed == Arming::BySpeed && low->time == starts_[guard].time && low->rate > 0;
    // The zero lies before, in what is no more than rounding, as at the end of a time for which the guard stays at zero.
    const bool isPast = low->value <= zero && low->rate < 0;
    const bool isOnlyZero =
        isExact && ((((isPositive && comesFromAbove) || isHop) && fallsOnce(part, zero, error)) || (isPast && comesFromAbove));
    if (falls && (isOnlyZero || isFinest)) {
      bracketProbes(guard, *low, *high, first);
      return;
    }
    // What is no more than rounding, or hardly changes, has no zero that could be told.
    const double change = std::max(part.length * std::max(std::abs(low->rate), std::abs(high->rate)), error);
    if (isFinest || change <= 0.01 * leave || std::max({std::abs(low->value), std::abs(high->value), change}) <= leave)
      continue;
    divide(guard, *low, *high, fit, depth + 1, first);
    if (first.guard >= 0)
      return;
  }
}

void EventDetection::bracketProbes(int guard, const Probe &low, const Probe &high, DetectedEvent &first) {
  const auto fill = [this, guard](const Probe &from, Sample &sample) {
    sample.time = from.time;
    sample.value.resize(dynamics_.guards().size());
    sample.rate.resize(dynamics_.guards().size());
    sample.value[guard] = from.value;
    sample.rate[guard] = from.rate;
  };
  fill(low, pool_[0]);
  fill(high, pool_[1]);
  bracket(guard, pool_[0], pool_[1], first);
}

}  // namespace tf::runtime
