#include "runtime/integrate/rock4.h"

#include "runtime/integrate/hermite_interpolation.h"

#include <algorithm>

namespace tf::runtime {

Rock4::Rock4(int size)
    : ElementMethod(size), tableau_(nullptr), begin_(size), beginRate_(size), before_(size), last_(size), next_(size),
      stages_(static_cast<std::size_t>(size) * Rock4Tableau::lastStages), point_(size) {}

bool Rock4::evaluate(ModeDynamics &dynamics, double time, const double *change, double *rate) {
  for (int i = 0; i < n_; ++i)
    point_[i] = begin_[i] + change[i];
  return dynamics.evaluate(time, point_.data(), rate);
}

bool Rock4::solveRecurrence(ModeDynamics &dynamics, double t0) {
  const Rock4Tableau &t = *tableau_;
  for (int i = 0; i < n_; ++i) {
    before_[i] = 0;
    last_[i] = h_ * t.mu[0] * beginRate_[i];
  }
  lastRate_ = beginRate_;
  for (std::size_t j = 1; j < t.mu.size(); ++j) {
    if (!evaluate(dynamics, t0 + h_ * t.node[j - 1], last_.data(), lastRate_.data()))
      return false;
    const double kappa = t.kappa[j], step = h_ * t.mu[j];
    for (int i = 0; i < n_; ++i)
      next_[i] = last_[i] + kappa * (last_[i] - before_[i]) + step * lastRate_[i];
    std::swap(before_, last_);
    std::swap(last_, next_);
  }
  return true;
}

bool Rock4::solveLast(ModeDynamics &dynamics, double t0) {
  const Rock4Tableau &t = *tableau_;
  for (std::size_t s = 0; s < Rock4Tableau::lastStages; ++s) {
    for (int i = 0; i < n_; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < s; ++j)
        sum += t.weights[s][j] * stages_[j * n_ + i];
      next_[i] = last_[i] + h_ * sum;
    }
    if (!evaluate(dynamics, t0 + h_ * t.lastNode[s], next_.data(), stages_.data() + s * n_))
      return false;
  }
  for (int i = 0; i < n_; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < Rock4Tableau::lastStages; ++j)
      sum += t.result[j] * stages_[j * n_ + i];
    end_[i] = begin_[i] + (last_[i] + h_ * sum);
  }
  return dynamics.evaluate(t0 + h_, end_.data(), endRate_.data());
}

bool Rock4::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double * /*scale*/,
                  double /*accuracy*/) {
  const tf_model &model = dynamics.model().model();
  nq_ = model.kinematics == nullptr ? model.nq : 0;
  h_ = h;
  tableau_ = &rock4TableauFor(h * radius_);
  std::copy_n(y0, n_, begin_.begin());
  std::copy_n(f0, n_, beginRate_.begin());
  if (!solveRecurrence(dynamics, t0) || !solveLast(dynamics, t0))
    return false;
  estimateError();
  return true;
}

void Rock4::estimateError() {
  const auto &weights = tableau_->error;
  for (int i = 0; i < n_; ++i) {
    double sum = weights[0] * lastRate_[i];
    for (std::size_t j = 0; j < Rock4Tableau::lastStages; ++j)
      sum += weights[j + 1] * stages_[j * n_ + i];
    error_[i] = h_ * sum;
  }
}

void Rock4::interpolate(double theta, double *y) const {
  interpolateBetween({begin_.data(), beginRate_.data(), end_.data(), endRate_.data(), h_, n_, nq_}, theta, y);
}

}  // namespace tf::runtime
