#include "runtime/integrate/smooth_integrator.h"

namespace tf::runtime {

bool SmoothIntegrator::moveInside(double time) {
  interpolate(time, end_.data());
  moveEnd(time);
  return dynamics_.evaluate(time, end_.data(), endRate_.data());
}

}  // namespace tf::runtime
