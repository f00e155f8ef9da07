#include "runtime/integrate/explicit_method.h"

namespace tf::runtime {

void ExplicitMethod::beginStep(const double *y0, const double *f0, double h) {
  h_ = h;
  hasDense_ = false;
  for (int i = 0; i < n_; ++i) {
    begin_[i] = y0[i];
    stages_[i] = f0[i];
  }
}

double ExplicitMethod::stabilityRatio() const {
  const double *last = stage(stageCount_ - 1);
  double rates = 0, states = 0;
  for (int i = 0; i < n_; ++i) {
    rates += (endRate_[i] - last[i]) * (endRate_[i] - last[i]);
    states += (end_[i] - point_[i]) * (end_[i] - point_[i]);
  }
  return states > 0 ? std::abs(h_) * std::sqrt(rates / states) / stabilityBorder_ : 0;
}

}  // namespace tf::runtime
