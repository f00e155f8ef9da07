#include "runtime/contact/restitution.h"

#include "runtime/contact/numbers.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

bool compresses(double velocity, double acceleration) { return velocity < 0 || (velocity == 0 && acceleration < 0); }

}  // namespace

void Restitution::begin(std::span<const double> coefficient, std::span<const ImpactLaw> law, std::span<const double> rate,
                        std::span<const double> normalVelocity) {
  const std::size_t n = coefficient.size();
  coefficient_.assign(coefficient.begin(), coefficient.end());
  law_.assign(law.begin(), law.end());
  rate_.assign(rate.begin(), rate.end());
  target_.assign(n, 0.0);
  for (std::vector<double> *values : {&impulse_, &work_, &impulseMagnitude_, &workMagnitude_})
    values->assign(n, 0.0);
  pushed_.assign(n, 0);
  several_ = false;
  for (std::size_t i = 0; i < n; ++i)
    if (law[i] == ImpactLaw::Newton)
      target_[i] = std::max(0.0, -coefficient[i] * normalVelocity[i]);
}

bool Restitution::push(std::span<const double> force) {
  if (several_)
    return false;
  for (std::size_t i = 0; i < pushed_.size(); ++i)
    pushed_[i] = pushed_[i] != 0 || force[i] > 0 ? 1 : 0;
  several_ = std::count(pushed_.begin(), pushed_.end(), 1) > 1;
  bool ended = false;
  for (std::size_t i = 0; several_ && i < pushed_.size(); ++i)
    if (law_[i] == ImpactLaw::Poisson && work_[i] <= 0) {
      ended = ended || impulse_[i] > 0;
      set(static_cast<int>(i), 0, 0);
    }
  return ended;
}

// The root of w = a (velocity t + acceleration t²/2), without cancellation.
double Restitution::workExhaustion(int i, double work, double velocity, double acceleration) const {
  const double discriminant = velocity * velocity + 2 * acceleration * work / rate_[i];
  if (discriminant < 0)
    return infinity;
  const double slope = velocity + std::sqrt(discriminant);
  return slope > 0 ? 2 * work / (rate_[i] * slope) : infinity;
}

double Restitution::exhaustion(int i, double impulse, double work, double velocity, double acceleration) const {
  if (law_[i] == ImpactLaw::Stronge)
    return workExhaustion(i, work, velocity, acceleration);
  const double time = impulse / rate_[i];
  return several_ ? std::min(time, workExhaustion(i, work, velocity, acceleration)) : time;
}

double Restitution::exhaustion(int i, double velocity, double acceleration) const {
  return compresses(velocity, acceleration) || !stored(i) ? infinity : exhaustion(i, impulse_[i], work_[i], velocity, acceleration);
}

// ∫ −a c2 dt, of Stronge's law with ε² where the contact compresses.
double Restitution::workOf(int i, double velocity, double acceleration, double duration) const {
  const double share = law_[i] == ImpactLaw::Stronge && compresses(velocity, acceleration) ? coefficient_[i] * coefficient_[i] : 1;
  return -rate_[i] * share * (velocity * duration + 0.5 * acceleration * duration * duration);
}

double Restitution::exhaustionThroughZero(int i, double velocity, double acceleration) const {
  const double turn = -velocity / acceleration;
  if (velocity < 0 && acceleration > 0 && storesWork(i)) {
    const double impulse = impulse_[i] + coefficient_[i] * rate_[i] * turn, work = work_[i] + workOf(i, velocity, acceleration, turn);
    return turn + exhaustion(i, impulse, work, 0, acceleration);
  }
  const double time = exhaustion(i, velocity, acceleration);
  return velocity > 0 && acceleration < 0 && time > turn ? infinity : time;
}

void Restitution::advanceThroughZero(int i, double velocity, double acceleration, double duration, bool exhausted) {
  const double turn = velocity * acceleration < 0 ? -velocity / acceleration : duration;
  advance(i, velocity, acceleration, std::min(turn, duration), exhausted && turn >= duration);
  if (turn < duration)
    advance(i, 0, acceleration, duration - turn, exhausted);
}

void Restitution::advance(int i, double velocity, double acceleration, double duration, bool exhausted) {
  if (!storesWork(i))
    return;
  const bool compressing = compresses(velocity, acceleration);
  if (!compressing && !stored(i))
    return;
  const double work = workOf(i, velocity, acceleration, duration);
  work_[i] += work;
  workMagnitude_[i] += std::abs(work);
  if (law_[i] == ImpactLaw::Poisson) {
    const double impulse = rate_[i] * duration * (compressing ? coefficient_[i] : -1);
    impulse_[i] += impulse;
    impulseMagnitude_[i] += std::abs(impulse);
  }
  if (compressing)
    return;
  // Contacts that end at the same instant differ by rounding.
  const bool usedUp = law_[i] == ImpactLaw::Stronge ? work_[i] <= roundingOfSums * workMagnitude_[i]
                                                    : impulse_[i] <= roundingOfSums * impulseMagnitude_[i] || !stored(i);
  if (exhausted || usedUp)
    set(i, 0, 0);
}

double Restitution::discard(int i) {
  const double target = target_[i];
  target_[i] = 0;
  set(i, 0, 0);
  return target;
}

void Restitution::set(int i, double impulse, double work) {
  impulse_[i] = impulse;
  work_[i] = work;
  impulseMagnitude_[i] = std::abs(impulse);
  workMagnitude_[i] = std::abs(work);
}

}  // namespace tf::runtime
