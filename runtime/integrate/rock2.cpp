#include "runtime/integrate/rock2.h"

namespace tf::runtime {

Rock2::Rock2(int size, double tolerance) : StabilisedMethod(size, tolerance, Rock2Tableau::lastStages, Curve::Cubic, 1) {}

bool Rock2::solveLast(ModeDynamics &dynamics, double t0) {
  const Rock2Tableau &t = *tableau_;
  double *first = stage(0), *second = stage(1);
  if (!evaluate(dynamics, t0 + h_ * t.lastNode[0], last_.data(), first))
    return false;
  for (int i = 0; i < n_; ++i)
    next_[i] = last_[i] + h_ * t.weight * first[i];
  if (!evaluate(dynamics, t0 + h_ * t.lastNode[1], next_.data(), second))
    return false;
  for (int i = 0; i < n_; ++i) {
    end_[i] = begin_[i] + (last_[i] + h_ * (t.result[0] * first[i] + t.result[1] * second[i]));
    error_[i] = h_ * (t.error[0] * lastRate_[i] + t.error[1] * first[i] + t.error[2] * second[i]);
  }
  return true;
}

}  // namespace tf::runtime
