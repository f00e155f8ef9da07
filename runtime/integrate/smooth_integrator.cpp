#include "runtime/integrate/smooth_integrator.h"

#include "runtime/integrate/hermite_interpolation.h"

namespace tf::runtime {

void SmoothIntegrator::interpolateEnds(double time, double *state) const {
  const tf_model &model = dynamics_.model().model();
  const double length = endTime_ - beginTime_;
  interpolateBetween(
      {begin_.data(), beginRate_.data(), end_.data(), endRate_.data(), length, n_, model.kinematics == nullptr ? model.nq : 0},
      (time - beginTime_) / length, state);
}

bool SmoothIntegrator::moveInside(double time) {
  interpolate(time, end_.data());
  moveEnd(time);
  return dynamics_.evaluate(time, end_.data(), endRate_.data());
}

}  // namespace tf::runtime
