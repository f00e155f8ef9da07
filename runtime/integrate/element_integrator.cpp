#include "runtime/integrate/element_integrator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// Of implicit equations with slips of two components near zero: their directions amplify rounding errors.
constexpr double turningAccuracy = 1e-12;

double smallestStep(double time) { return 16 * epsilon * std::max(std::abs(time), 1e-3); }

}  // namespace

ElementIntegrator::ElementIntegrator(ModeDynamics &dynamics, IntegratorSettings settings, std::unique_ptr<ElementMethod> method)
    : SmoothIntegrator(dynamics, std::move(settings)), method_(std::move(method)), uniform_(n_), scale_(n_), trial_(n_), trialRate_(n_),
      slope_(n_) {}

void ElementIntegrator::start(double time, const double *state, const double *rate, double firstStep) {
  beginTime_ = endTime_ = time;
  std::copy_n(state, n_, end_.begin());
  std::copy_n(rate, n_, endRate_.begin());
  next_ = firstStep > 0 ? firstStep : 0;
  error_ = 1;
  first_ = true;
  moved_ = isUniform_ = isHeld_ = false;
  method_->restart(dynamics_.hasTurningSlips());
  unstableSteps_ = stableSteps_ = 0;
}

void ElementIntegrator::resetStatistics() {
  statistics_ = {};
  method_->jacobians = method_->iterations = 0;
}

// Hairer, Wanner II, IV.2: fifteen steps at the border of stability, fewer than six in a row inside it.
void ElementIntegrator::watchStability() {
  if (method_->stabilityRatio() > 1) {
    stableSteps_ = 0;
    ++unstableSteps_;
  } else if (++stableSteps_ >= 6) {
    unstableSteps_ = 0;
  }
}

void ElementIntegrator::updateScale() {
  for (int i = 0; i < n_; ++i)
    scale_[i] = std::max(settings_.scale[i], std::abs(begin_[i]));
}

// Along an explicit Euler step: to the limit where the accelerations stay the same, as far as one is suggested where they do not, else as
// Hairer, Nørsett, Wanner I, II.4: the step of which the method's error is about the tolerance, if higher derivatives are like the first.
double ElementIntegrator::initialStep(double limit) {
  if (std::isinf(next_))
    return limit - beginTime_;
  if (next_ > 0 && changingStarts_ >= mostChangingStarts && ++changingStarts_ % startsPerLook != 0)
    return next_;
  double d0 = 0, d1 = 0, d2 = 0;
  for (int i = 0; i < n_; ++i) {
    d0 = std::max(d0, std::abs(begin_[i]) / scale_[i]);
    d1 = std::max(d1, std::abs(beginRate_[i]) / scale_[i]);
  }
  const double span = limit - beginTime_;
  double h = d0 < 1e-5 || d1 < 1e-5 ? 1e-3 * span : 0.01 * d0 / d1;
  h = std::min(h, span);
  for (int i = 0; i < n_; ++i)
    trial_[i] = begin_[i] + h * beginRate_[i];
  if (!dynamics_.evaluate(beginTime_ + h, trial_.data(), trialRate_.data()))
    return std::min(h, 1e-6 * span);
  bool same = !dynamics_.hasTurningSlips();
  for (int i = 0; i < n_; ++i) {
    const double change = std::abs(trialRate_[i] - beginRate_[i]);
    d2 = std::max(d2, change / scale_[i] / h);
    same = same && (i < dynamics_.model().model().nq ||
                    change <= std::max(1e-12 * std::abs(beginRate_[i]), 1e-3 * settings_.tolerance * scale_[i] * h / (span * span)));
  }
  changingStarts_ = same ? 0 : changingStarts_ + 1;
  if (same)
    return span;
  if (next_ > 0)
    return next_;
  const double h1 = std::pow(0.5 * settings_.tolerance / std::max(d1, d2), 1 / method_->errorOrder());
  return std::clamp(std::min(100 * h, h1), smallestStep(beginTime_), span);
}

// Of implicit equations: well below the error that is allowed in a step.
double ElementIntegrator::stepAccuracy() const { return settings_.fixedStep > 0 ? 1e-15 : std::max(1e-15, 1e-3 * settings_.tolerance); }

bool ElementIntegrator::solve(double h, double accuracy) {
  length_ = h;
  dynamics_.restartMargins();
  // As little can be taken for granted of rates that have peaks.
  method_->setDistance(dynamics_.frictionMayPeak() ? 0 : (beginTime_ - switchTime_) / h);
  return method().solve(dynamics_, beginTime_, begin_.data(), beginRate_.data(), h, scale_.data(), accuracy);
}

void ElementIntegrator::adopt(double time) {
  endTime_ = elementEnd_ = time;
  std::copy_n(method().end(), n_, end_.begin());
  std::copy_n(method().endRate(), n_, endRate_.begin());
  statistics_.jacobians = method_->jacobians;
  statistics_.iterations = method_->iterations;
}

// From the begin of the step, which becomes exactly at rest where it is.
bool ElementIntegrator::startsUniform() {
  if (settings_.fixedStep > 0)
    return false;
  if (dynamics_.isUniform())
    return true;
  isHeld_ = isHeld_ || dynamics_.isHeldAtRest(beginTime_, begin_.data(), beginRate_.data(), scale_.data());
  if (isHeld_)
    std::fill(beginRate_.begin(), beginRate_.end() - 1, 0.0);
  return isHeld_;
}

void ElementIntegrator::moveUniformly(double limit) {
  moved_ = false;
  error_ = 0;
  solve(limit - beginTime_, 0);
  ++statistics_.steps;
  adopt(limit);
}

// Of a step that goes safely beyond the event that is expected. One that goes much farther may have failed for what lies behind the event.
double ElementIntegrator::lengthBeyondEvent() const {
  constexpr double beyond = 2, shortest = 1e4;
  const double length = beyond * (expected_ - beginTime_);
  return length > shortest * smallestStep(beginTime_) ? length : std::numeric_limits<double>::infinity();
}

// What the rate at t0 + theta h, theta ≤ 31/32, and that of the last element's interpolant there differ by, relative to the tolerance, as
// if they did so over a sixteenth of the element.
double ElementIntegrator::defectAt(double theta) {
  constexpr double part = 1.0 / 16, increment = 1.0 / 128;
  // The derivative at the first of five places of the polynomial of degree 4 through values there.
  constexpr double stencil[] = {-25.0 / 12, 4, -3, 4.0 / 3, -0.25};
  const double h = length_;
  std::fill(slope_.begin(), slope_.end(), 0.0);
  for (int k = 4; k >= 0; --k) {
    method().interpolate(theta + k * increment, trial_.data());
    for (int i = 0; i < n_; ++i)
      slope_[i] += stencil[k] / (increment * h) * trial_[i];
  }
  if (!dynamics_.evaluate(beginTime_ + theta * h, trial_.data(), trialRate_.data()))
    return std::numeric_limits<double>::infinity();
  double defect = 0;
  for (int i = 0; i < n_; ++i)
    defect = std::max(defect, part * h * std::abs(trialRate_[i] - slope_[i]) / (settings_.tolerance * scale_[i]));
  return defect;
}

// Friction that depends on the slip may have a peak where this begins or ends, of which the estimates of methods show a small part only, or
// by chance none. Looks for it at places in the last element.
bool ElementIntegrator::meetsPeak(std::span<const double> places) {
  constexpr double largestDefect = 4;
  return std::any_of(places.begin(), places.end(), [this](double theta) { return !(defectAt(theta) <= largestDefect); });
}

StepStatus ElementIntegrator::step(double limit) {
  if (moved_)
    method_->accept();
  const double longest = longestUniform();
  beginTime_ = endTime_;
  begin_ = end_;
  beginRate_ = endRate_;
  updateScale();
  isShortened_ = false;
  isUniform_ = startsUniform();
  if (isUniform_) {
    moveUniformly(limit);
    return StepStatus::Done;
  }
  const double span = limit - beginTime_;
  const bool fixed = settings_.fixedStep > 0;
  if (fixed)
    next_ = settings_.fixedStep;
  else if (first_)
    next_ = initialStep(limit);
  next_ = std::min(next_, longest);
  const double accuracy = stepAccuracy();
  for (bool rejected = false;; rejected = true) {
    next_ = method_->adjustStep(next_, dynamics_, beginTime_, begin_.data(), beginRate_.data(), scale_.data());
    const bool last = next_ >= span * (1 - 1e-12);
    // No tiny remainder before the limit.
    const double h = last ? span : !fixed && next_ > 0.5 * span && next_ < 0.999 * span ? 0.5 * span : next_;
    if (h <= smallestStep(beginTime_) && !last)
      return StepStatus::TooSmall;
    if (!solve(h, accuracy) && !(dynamics_.hasTurningSlips() && accuracy < turningAccuracy && solve(h, turningAccuracy))) {
      if (h <= 1e4 * smallestStep(beginTime_))
        return StepStatus::Unsolvable;
      ++statistics_.rejected;
      next_ = 0.2 * h;
      continue;
    }
    const double error = fixed ? 0 : method_->errorNorm(scale_.data(), settings_.tolerance);
    if (!(error <= 1) && !fixed) {
      ++statistics_.rejected;
      method_->reject(scale_.data());
      next_ = h * std::clamp(0.9 * std::pow(error, -1 / method_->errorOrder()), 0.1, 0.9);
      if (!std::isfinite(error))
        next_ = 0.1 * h;
      next_ = std::min(next_, lengthBeyondEvent());
      continue;
    }
    constexpr double behindBegin[] = {0, 1.0 / 32, 1.0 / 8}, shorter = 0.25;
    if (first_ && watchesPeaks()) {
      if (meetsPeak(behindBegin)) {
        ++statistics_.rejected;
        method_->reject(scale_.data());
        next_ = shorter * h;
        continue;
      }
      if (!dynamics_.evaluate(beginTime_ + h, method_->end(), method_->endRate()))
        return StepStatus::Unsolvable;
    }
    const double largest = rejected ? 1 : first_ ? 100 : 8;
    const double growth = error <= 1e-12 ? largest : std::min(largest, std::max(0.2, 0.9 * std::pow(error, -1 / method_->errorOrder())));
    // A step that the limit cut short says little about the next one.
    next_ = last ? std::max(next_, h * growth) : h * growth;
    first_ = false;
    moved_ = true;
    error_ = error;
    ++statistics_.steps;
    watchStability();
    method_->finish(error, scale_.data());
    adopt(last ? limit : beginTime_ + h);
    return StepStatus::Done;
  }
}

bool ElementIntegrator::shorten(double time) {
  // Where slips of two components have just begun, implicit equations cannot be solved to rounding, but as well as those of the step.
  if (!solve(time - beginTime_, 1e-15) && !solve(time - beginTime_, stepAccuracy()))
    return false;
  // Forces without bound between the ends of a step may be where a stage of a shorter one is.
  constexpr double largestError = 1e3;
  shortenedError_ = settings_.fixedStep > 0 ? 0 : method().errorNorm(scale_.data(), settings_.tolerance);
  if (!(shortenedError_ <= largestError))
    return false;
  isShortened_ = true;
  adopt(time);
  return true;
}

// Estimates of shorter steps may be larger, by a little, where higher derivatives cancel in that of the step.
bool ElementIntegrator::isResolved() {
  constexpr double largestError = 4, shortest = 1e4, beforeEnd[] = {7.0 / 8, 31.0 / 32};
  if (!isShortened_ || endTime_ - beginTime_ <= shortest * smallestStep(beginTime_))
    return true;
  if (!(shortenedError_ <= largestError))
    return false;
  return !watchesPeaks() || (!meetsPeak(beforeEnd) && dynamics_.evaluate(endTime_, end_.data(), trialRate_.data()));
}

void ElementIntegrator::interpolate(double time, double *state) {
  method().interpolate((time - beginTime_) / (elementEnd_ - beginTime_), state);
}

}  // namespace tf::runtime
