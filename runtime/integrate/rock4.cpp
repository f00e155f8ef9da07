#include "runtime/integrate/rock4.h"

namespace tf::runtime {

Rock4::Rock4(int size, double tolerance) : StabilisedMethod(size, tolerance, Rock4Tableau::lastStages, Curve::Quintic, 3) {}

bool Rock4::solveLast(ModeDynamics &dynamics, double t0) {
  const Rock4Tableau &t = *tableau_;
  for (std::size_t s = 0; s < Rock4Tableau::lastStages; ++s) {
    for (int i = 0; i < n_; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < s; ++j)
        sum += t.weights[s][j] * stage(j)[i];
      next_[i] = last_[i] + h_ * sum;
    }
    if (!evaluate(dynamics, t0 + h_ * t.lastNode[s], next_.data(), stage(s)))
      return false;
  }
  for (int i = 0; i < n_; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < Rock4Tableau::lastStages; ++j)
      sum += t.result[j] * stage(j)[i];
    end_[i] = begin_[i] + (last_[i] + h_ * sum);
  }
  estimateError();
  return true;
}

void Rock4::estimateError() {
  const auto &weights = tableau_->error;
  for (int i = 0; i < n_; ++i) {
    double sum = weights[0] * lastRate_[i];
    for (std::size_t j = 0; j < Rock4Tableau::lastStages; ++j)
      sum += weights[j + 1] * stage(j)[i];
    error_[i] = h_ * sum;
  }
}

}  // namespace tf::runtime
