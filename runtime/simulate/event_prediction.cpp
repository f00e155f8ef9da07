// Where the next event is expected: a step that ends right behind it need not be solved a second time to end at it.
#include "runtime/contact/numbers.h"
#include "runtime/integrate/parabola_zero.h"
#include "runtime/simulate/event_detection.h"

#include <algorithm>
#include <limits>

namespace tf::runtime {

namespace {

// Parts of a step that the expected zero may be missed by: the integrator's reach covers it on both sides of the step's end.
constexpr double margin = 0.5;

}  // namespace

// Gaps along parabolas and slips along lines, by the change of their rates over an increment of time, which takes no evaluation of the
// dynamics.
double EventDetection::expected() {
  const double increment = stepAside(integrator_->endTime(), integrator_->end(), integrator_->endRate());
  first_.value.resize(dynamics_.guards().size());
  first_.rate.resize(dynamics_.guards().size());
  first_.time = std::numeric_limits<double>::quiet_NaN();
  dynamics_.switchingValues(awake_, first_.value.data(), first_.rate.data());
  double earliest = infinity;
  for (const int k : awake_) {
    const Guard &guard = dynamics_.guards()[k];
    double time = infinity;
    if (guard.kind == GuardKind::Gap) {
      const double gap = begin_.value[k] > threshold(k) ? begin_.value[k] : 0;
      time = parabolaZero(gap, begin_.rate[k], (first_.rate[k] - begin_.rate[k]) / increment);
    } else if (guard.kind == GuardKind::Slip && begin_.value[k] > threshold(k)) {
      const double slope = (first_.value[k] - begin_.value[k]) / increment;
      time = slope < 0 ? -begin_.value[k] / slope : infinity;
    }
    earliest = std::min(earliest, time);
  }
  return earliest;
}

double EventDetection::stepLimit(double limit) {
  const bool mayCut = !cut_;
  const bool tries = dynamics_.model().model().nv > RowSystem::narrow && !dynamics_.guards().empty() &&
                     integrator_->settings().fixedStep <= 0 && integrator_->reach() > 0;
  cut_ = false;
  integrator_->expectEvent(infinity);
  if (!tries)
    return limit;
  const double begin = integrator_->endTime(), distance = expected(), length = distance * (1 + margin * integrator_->reach());
  integrator_->expectEvent(begin + distance);
  // After a step that has ended where nothing happened the next one is as long as the error allows.
  if (!mayCut)
    return limit;
  // A step much shorter than times can be told apart would not end where it should.
  if (!(length > 1e4 * std::numeric_limits<double>::epsilon() * std::abs(begin)) || !(begin + length < limit))
    return limit;
  cut_ = true;
  return cutTime_ = begin + length;
}

}  // namespace tf::runtime
