#include "runtime/integrate/smooth_integrator.h"

#include "runtime/integrate/hermite_interpolation.h"
#include "runtime/integrate/parabola_zero.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

void SmoothIntegrator::interpolateEnds(double time, double *state) const {
  const tf_model &model = dynamics_.model().model();
  const double length = endTime_ - beginTime_;
  interpolateBetween(
      {begin_.data(), beginRate_.data(), end_.data(), endRate_.data(), length, n_, model.kinematics == nullptr ? model.nq : 0},
      (time - beginTime_) / length, state);
}

double SmoothIntegrator::longestUniform() const {
  constexpr double part = 1.0 / 32;
  const tf_model &model = dynamics_.model().model();
  double longest = std::numeric_limits<double>::infinity();
  if ((model.locality & TF_LOCAL_FORCES) == 0 || settings_.fixedStep > 0)
    return longest;
  const double last = endTime_ - beginTime_;
  for (int i = model.nq; i < model.nq + model.nv; ++i)
    if (last * std::abs(endRate_[i] - beginRate_[i]) > settings_.tolerance * settings_.scale[i])
      return longest;
  const bool hasVelocities = model.kinematics == nullptr;
  for (int i = 0; i < model.nq; ++i) {
    const double way = part * std::max(settings_.scale[i], std::abs(end_[i]));
    const double acceleration = hasVelocities ? std::abs(endRate_[model.nq + i]) : 0;
    longest = std::min(longest, parabolaZero(way, -std::abs(endRate_[i]), -acceleration));
  }
  return longest;
}

bool SmoothIntegrator::moveInside(double time) {
  interpolate(time, end_.data());
  moveEnd(time);
  return dynamics_.evaluate(time, end_.data(), endRate_.data());
}

}  // namespace tf::runtime
