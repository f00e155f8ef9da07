#include "runtime/integrate/stabilised_pair.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Steps at the border of stability that tell stiffness. Fewer than where CVODE takes over (Hairer, Wanner, Solving Ordinary Differential
// Equations II, IV.2): nothing is lost where they are wrong.
constexpr int leastPatience = 8, mostPatience = 10000;
constexpr int leastPause = 4, mostPause = 1000;
// So far beyond the pair's border a step must reach, that it is the stabilised method's.
constexpr double leastStabilised = 1.2;
// The Jacobian changes slowly along the motion (Abdulle 2002).
constexpr int stepsPerEstimate = 25;
// Steps at the border, in a row, that show that the radius is larger than its bound.
constexpr int doubtfulPatience = 3;

}  // namespace

StabilisedPair::StabilisedPair(int size, std::unique_ptr<ExplicitMethod> pair, std::unique_ptr<ExplicitMethod> low,
                               std::unique_ptr<StabilisedMethod> stabilised)
    : ElementMethod(size), pair_(std::move(pair)), low_(std::move(low)), border_(pair_->stabilityBorder()),
      stabilised_(std::move(stabilised)), radius_(size), patience_(leastPatience), pause_(leastPause), pauseLeft_(0) {}

void StabilisedPair::restart(bool slipsTurn) {
  isNewMode_ = true;
  slipsTurn_ = slipsTurn && low_ != nullptr;
  adjustedSteps_ = 0;
  endsEarly_ = modeSteps_ == 1;
  modeSteps_ = 0;
  lowLength_ = 0;
  isLow_ = slipsTurn_;
  isStabilised_ = false;
}

void StabilisedPair::forget() {
  modeSteps_ = 0;
  restart(false);
  radius_.forget();
  isKnown_ = isDamped_ = mayStabilise_ = false;
  borderSteps_ = doubtfulSteps_ = wasted_ = pauseLeft_ = 0;
  patience_ = leastPatience;
  pause_ = leastPause;
}

// Slips that turn, faster and faster as they end, change the spectrum within a step.
double StabilisedPair::adjustStep(double h, ModeDynamics &dynamics, double t0, const double *y0, const double *f0, const double *scale) {
  mayStabilise_ = isAdjusted_ = false;
  isDamped_ = isKnown_ && !dynamics.hasTurningSlips();
  if (!isDamped_ || (radius_.isKnown() && !isDoubted() && h * radius_.bound() <= border_))
    return h;
  if (needsEstimate(h)) {
    radius_.estimate(dynamics, t0, y0, f0, modeSteps_ == 0, scale);
    stepsSinceEstimate_ = doubtfulSteps_ = 0;
    isNewMode_ = false;
  }
  if (!radius_.isDamping()) {
    isKnown_ = isDamped_ = false;
    borderSteps_ = 0;
    patience_ = std::min(4 * patience_, mostPatience);
    return h;
  }
  const double reach = h * radius_.bound();
  if (reach <= border_)
    return h;
  isAdjusted_ = true;
  mayStabilise_ = pauseLeft_ == 0 && reach >= leastStabilised * border_;
  return std::min(h, (mayStabilise_ ? stabilised_->border() : border_) / radius_.bound());
}

bool StabilisedPair::isDoubted() const { return doubtfulSteps_ >= doubtfulPatience; }

// The largest eigenvalue seldom grows much from mode to mode: contacts that close make it smaller. Steps of many stages are worth an
// estimate, or several steps in one mode; too small a one shows in the error.
bool StabilisedPair::needsEstimate(double h) const {
  constexpr double many = 25;
  constexpr int several = 2;
  return !radius_.isKnown() || stepsSinceEstimate_ >= stepsPerEstimate ||
         (isNewMode_ && (h * radius_.bound() > many || adjustedSteps_ >= several));
}

// A step of a mode whose slips turn, one clearly shorter than the error would end it, or, at first, in a mode that may end as early as the
// one before.
bool StabilisedPair::mayBeLow(double h) const {
  constexpr double clearly = 0.7;
  if (slipsTurn_)
    return true;
  if (!low_ || (isDamped_ && radius_.isKnown() && h * radius_.bound() > low_->stabilityBorder()))
    return false;
  return lowLength_ > 0 ? h <= clearly * lowLength_ : endsEarly_ && modeSteps_ == 0;
}

bool StabilisedPair::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
                           double accuracy) {
  length_ = h;
  isStabilised_ = mayStabilise_ && h * radius_.bound() > border_;
  isLow_ = !isStabilised_ && mayBeLow(h);
  if (isStabilised_)
    stabilised_->setRadius(radius_.bound());
  ElementMethod &method = current();
  method.setDistance(distance_);
  if (!method.solve(dynamics, t0, y0, f0, h, scale, accuracy))
    return false;
  std::copy_n(method.end(), n_, end_.begin());
  std::copy_n(method.endRate(), n_, endRate_.begin());
  return true;
}

// The error of a step that is not stable is in the direction that the radius is wrong for. Transients are the pair's.
void StabilisedPair::reject(const double *scale) {
  wasted_ += isStabilised_ ? stabilised_->interiorStages() + 1 : explicitMethod().evaluations();
  if (isLow_)
    endsEarly_ = false;
  lowLength_ = 0;
  if (isStabilised_ && stabilised_->leapsTransient(scale))
    pauseLeft_ = std::max(pauseLeft_, leastPause);
  else if (isStabilised_)
    doubtRadius(stabilised_->error(), scale);
}

void StabilisedPair::doubtRadius(const double *error, const double *scale) {
  radius_.suspect(error, scale);
  stepsSinceEstimate_ = stepsPerEstimate;
}

// Explicit steps that are at their border where the bound of the radius has them well inside.
void StabilisedPair::watchBorder(const double *scale) {
  const ExplicitMethod &method = explicitMethod();
  const bool isInside = isDamped_ && radius_.isKnown() && length_ * radius_.bound() < 0.9 * method.stabilityBorder();
  doubtfulSteps_ = isInside && method.stabilityRatio() > 1 ? doubtfulSteps_ + 1 : 0;
  if (isDoubted())
    doubtRadius(method.error(), scale);
}

void StabilisedPair::finish(double error, const double *scale) {
  // Of the pair's steps those of the lower order are a part, to a factor of two over usual tolerances.
  constexpr double part = 0.25, longest = 8;
  ++modeSteps_;
  if (isStabilised_) {
    ++stepsSinceEstimate_;
    judge();
  } else {
    const double growth = error > 0 ? std::min(longest, 0.9 * std::pow(error, -1 / errorOrder())) : longest;
    lowLength_ = (isLow_ ? 1 : part) * length_ * growth;
    pauseLeft_ = std::max(pauseLeft_ - 1, 0);
    borderSteps_ = explicitMethod().stabilityRatio() > 0.8 ? borderSteps_ + 1 : std::max(borderSteps_ - 1, 0);
    isKnown_ = stabilised_ && (isKnown_ || borderSteps_ >= patience_);
    watchBorder(scale);
  }
  adjustedSteps_ += isAdjusted_ ? 1 : 0;
  wasted_ = 0;
}

// Time per evaluation against that of the pair at its border. Where accuracy limits the steps, the pair's order is better.
void StabilisedPair::judge() {
  const double own = length_ * radius_.bound() / (stabilised_->interiorStages() + 1 + wasted_);
  if (own >= border_ / pair_->evaluations()) {
    pause_ = leastPause;
    patience_ = leastPatience;
  } else {
    pauseLeft_ = pause_;
    pause_ = std::min(2 * pause_, mostPause);
  }
}

// Where the stabilised method would take longer steps, if they were as accurate, stability does not limit those of the pair. The longer a
// mode lasts, the more it is worth the begin of an implicit method.
double StabilisedPair::stabilityRatio() const {
  constexpr double lasting = 50;
  return isStabilised_               ? stabilised_->stabilityRatio() * (1 + modeSteps_ / lasting)
         : isDamped_ && !isDoubted() ? 0
                                     : explicitMethod().stabilityRatio();
}

}  // namespace tf::runtime
