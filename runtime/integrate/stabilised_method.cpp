#include "runtime/integrate/stabilised_method.h"

#include "runtime/integrate/hermite_interpolation.h"

#include <cmath>
#include <limits>
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

StabilisedMethod::StabilisedMethod(int size, double tolerance, int lastStages, Curve curve, int insideCount)
    : ElementMethod(size), begin_(size), last_(size), next_(size), beginRate_(size), before_(size),
      rates_(static_cast<std::size_t>(size) * lastStages), point_(size), bend_(size), curve_(curve), tolerance_(tolerance),
      inside_(size, insideCount) {}

bool StabilisedMethod::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double * /*scale*/,
                             double /*accuracy*/) {
  const tf_model &model = dynamics.model().model();
  integrals_ = curve_ == Curve::Quintic && model.kinematics == nullptr ? model.nq : 0;
  dynamics_ = &dynamics;
  t0_ = t0;
  inside_.forget();
  std::copy_n(y0, n_, begin_.begin());
  std::copy_n(f0, n_, beginRate_.begin());
  return advance(dynamics, t0, h) && dynamics.evaluate(t0 + h, end_.data(), endRate_.data());
}

bool StabilisedMethod::advance(ModeDynamics &dynamics, double t0, double h) {
  h_ = h;
  const StabilisedTableau &tableau = chooseTableau(h * radius_);
  stages_ = tableau.stages;
  return solveRecurrence(dynamics, t0, tableau) && solveLast(dynamics, t0);
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
    for (int i = 0; i < n_ && j == 1; ++i)
      bend_[i] = h_ / tableau.mu[0] * (lastRate_[i] - beginRate_[i]);
    const double kappa = tableau.kappa[j], step = h_ * tableau.mu[j];
    for (int i = 0; i < n_; ++i)
      next_[i] = last_[i] + kappa * (last_[i] - before_[i]) + step * lastRate_[i];
    std::swap(before_, last_);
    std::swap(last_, next_);
  }
  return true;
}

double StabilisedMethod::errorNorm(const double *scale, double tolerance) const {
  const double norm = largestError(scale) / tolerance;
  return norm <= 1 && leapsTransient(scale) ? std::numeric_limits<double>::infinity() : norm;
}

// The second derivative at the begin against that of the cubic through both ends with their rates: where the motion is smooth, they differ
// by the fourth derivative times h²/12; by λ² times what a component that decays at a rate λ ≫ 1/h differs from what it follows.
bool StabilisedMethod::leapsTransient(const double *scale) const {
  constexpr double tolerances = 10, leastReach = 8;
  const double reach = std::max(leastReach, h_ * radius_);
  for (int i = 0; i < n_ - 1; ++i) {
    const double ofCurve = 6 * (end_[i] - begin_[i]) - h_ * (4 * beginRate_[i] + 2 * endRate_[i]);
    if (std::abs(bend_[i] - ofCurve) > tolerances * tolerance_ * scale[i] * reach * reach)
      return true;
  }
  return false;
}

// The cubic with the rates at both ends is off by 4/27 h of what these are.
bool StabilisedMethod::hasExactRates() const {
  constexpr double tolerances = 5;
  return 4.0 / 27 * h_ * radius_ <= tolerances;
}

void StabilisedMethod::solveInside() {
  const std::vector<double> end = end_, error = error_;
  const double h = h_;
  const int stages = stages_;
  inside_.solve([&](double theta, double *state) {
    const bool isSolved = advance(*dynamics_, t0_, theta * h);
    std::copy(end_.begin(), end_.end(), state);
    return isSolved;
  });
  end_ = end;
  error_ = error;
  h_ = h;
  stages_ = stages;
  // The caller's last evaluation is that at the end.
  dynamics_->evaluate(t0_ + h_, end_.data(), point_.data());
}

void StabilisedMethod::interpolate(double theta, double *y) {
  if (isInterpolantDear())
    solveInside();
  if (inside_.isKnown())
    inside_.interpolate(theta, begin_.data(), end_.data(), y);
  else
    interpolateBetween({begin_.data(), beginRate_.data(), end_.data(), endRate_.data(), h_, n_, integrals_}, theta, y);
}

}  // namespace tf::runtime
