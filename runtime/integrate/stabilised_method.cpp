#include "runtime/integrate/stabilised_method.h"

#include "runtime/integrate/hermite_interpolation.h"

#include <cmath>
#include <numbers>

namespace tf::runtime {

// By the procedure of Stieltjes; Gauss–Chebyshev quadrature of so many nodes is exact for the scalar products of a w of degree 4.
void makeRecurrence(int count, double begin, double border, const std::function<double(double)> &w, StabilisedTableau &tableau) {
  const int nodes = count + 6;
  std::vector<double> x(nodes), weight(nodes), before(nodes, 0.0), last(nodes, 1.0);
  for (int k = 0; k < nodes; ++k) {
    x[k] = -begin - (border - begin) * (1 - std::cos((2 * k + 1) * std::numbers::pi / (2 * nodes))) / 2;
    weight[k] = w(x[k]) * w(x[k]);
  }
  double normBefore = 0;
  for (int j = 0; j < count; ++j) {
    double norm = 0, moment = 0;
    for (int k = 0; k < nodes; ++k) {
      norm += weight[k] * last[k] * last[k];
      moment += weight[k] * last[k] * last[k] * x[k];
    }
    const double centre = moment / norm, ratio = j > 0 ? norm / (normBefore * tableau.mu.back()) : 0;
    const double mu = -1 / (centre + ratio), kappa = mu * ratio;
    for (int k = 0; k < nodes; ++k) {
      const double next = mu * (x[k] - centre) * last[k] - kappa * before[k];
      before[k] = last[k];
      last[k] = next;
    }
    normBefore = norm;
    tableau.mu.push_back(mu);
    tableau.kappa.push_back(kappa);
  }
}

StabilisedMethod::StabilisedMethod(int size, int lastStages, Inside inside)
    : ElementMethod(size), begin_(size), last_(size), next_(size), beginRate_(size), before_(size),
      rates_(static_cast<std::size_t>(size) * lastStages), point_(size), inside_(inside) {}

bool StabilisedMethod::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double * /*scale*/,
                             double /*accuracy*/) {
  const tf_model &model = dynamics.model().model();
  integrals_ = inside_ == Inside::Quintic && model.kinematics == nullptr ? model.nq : 0;
  h_ = h;
  std::copy_n(y0, n_, begin_.begin());
  std::copy_n(f0, n_, beginRate_.begin());
  const StabilisedTableau &tableau = chooseTableau(h * radius_);
  stages_ = tableau.stages;
  return solveRecurrence(dynamics, t0, tableau) && solveLast(dynamics, t0) && dynamics.evaluate(t0 + h, end_.data(), endRate_.data());
}

bool StabilisedMethod::evaluate(ModeDynamics &dynamics, double time, const double *change, double *rate) {
  for (int i = 0; i < n_; ++i)
    point_[i] = begin_[i] + change[i];
  return dynamics.evaluate(time, point_.data(), rate);
}

// The last g and the rate at the one before it.
bool StabilisedMethod::solveRecurrence(ModeDynamics &dynamics, double t0, const StabilisedTableau &tableau) {
  for (int i = 0; i < n_; ++i) {
    before_[i] = 0;
    last_[i] = h_ * tableau.mu[0] * beginRate_[i];
  }
  lastRate_ = beginRate_;
  for (std::size_t j = 1; j < tableau.mu.size(); ++j) {
    if (!evaluate(dynamics, t0 + h_ * tableau.node[j - 1], last_.data(), lastRate_.data()))
      return false;
    const double kappa = tableau.kappa[j], step = h_ * tableau.mu[j];
    for (int i = 0; i < n_; ++i)
      next_[i] = last_[i] + kappa * (last_[i] - before_[i]) + step * lastRate_[i];
    std::swap(before_, last_);
    std::swap(last_, next_);
  }
  return true;
}

void StabilisedMethod::interpolate(double theta, double *y) const {
  interpolateBetween({begin_.data(), beginRate_.data(), end_.data(), endRate_.data(), h_, n_, integrals_}, theta, y);
}

}  // namespace tf::runtime
