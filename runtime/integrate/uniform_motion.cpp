#include "runtime/integrate/uniform_motion.h"

#include <algorithm>

namespace tf::runtime {

bool UniformMotion::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double * /*scale*/,
                          double /*accuracy*/) {
  const tf_model &model = dynamics.model().model();
  nq_ = model.nq;
  nv_ = model.nv;
  h_ = h;
  begin_ = y0;
  rate_ = f0;
  at(h, end_.data());
  std::copy_n(f0, n_, endRate_.begin());
  for (int i = 0; i < nv_; ++i)
    endRate_[i] += h * f0[nq_ + i];
  dynamics.keepEvaluation(t0 + h, end_.data());
  return true;
}

// Where there are accelerations, coordinates are as many as velocities, and their integrals.
void UniformMotion::at(double time, double *y) const {
  for (int i = 0; i < n_; ++i)
    y[i] = begin_[i] + time * rate_[i];
  for (int i = 0; i < nv_; ++i)
    y[i] += 0.5 * time * time * rate_[nq_ + i];
}

}  // namespace tf::runtime
