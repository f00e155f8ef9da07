// The optima of ConicForces with the limits that are active there: Newton's method on the optimality conditions, and limits that join or
// leave until no multiplier is negative and no other limit is violated.
#include "runtime/contact/conic_forces.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Relative to the force scale: of the last step, and what slacks and multipliers may be negative by.
constexpr double lastStep = 1e-9, slackRounding = 1e-13, multiplierRounding = 1e-11;
constexpr int mostSteps = 12, mostChanges = 12;
// Where the active limits do not determine the point of the largest common slack, steps are the shortest ones; where their slopes depend on
// one another, so do multipliers.
constexpr double shortest = 1e-6, dependent = 1e-10;

}  // namespace

// After `center`: on the central path multipliers are weight / slack.
void ConicForces::findActive(double weight, Optimum &optimum) const {
  optimum.active.clear();
  optimum.multiplier.resize(static_cast<Eigen::Index>(limits_.size()));
  Eigen::Index count = 0;
  for (std::size_t k = 0; k < limits_.size(); ++k) {
    const double distance = (slack(static_cast<int>(k), optimum.point) - optimum.common) / scale_;
    if (distance > std::sqrt(weight))
      continue;
    optimum.active.push_back(static_cast<int>(k));
    optimum.multiplier[count++] = weight / std::max(distance, weight);
  }
  optimum.multiplier.conservativeResize(count);
}

// While multipliers still change the active limits are not quite at their common slack.
bool ConicForces::obeysActive(const Optimum &optimum) const {
  return std::all_of(optimum.active.begin(), optimum.active.end(),
                     [&](int k) { return std::abs(slack(k, optimum.point) - optimum.common) <= slackRounding * scale_; });
}

// Of the limits that are not active; −1: none.
int ConicForces::mostViolated(const Optimum &optimum) const {
  int worst = -1;
  double least = optimum.common - slackRounding * scale_;
  for (std::size_t k = 0; k < limits_.size(); ++k)
    if (const double own = slack(static_cast<int>(k), optimum.point);
        own < least && std::find(optimum.active.begin(), optimum.active.end(), static_cast<int>(k)) == optimum.active.end()) {
      least = own;
      worst = static_cast<int>(k);
    }
  return worst;
}

bool ConicForces::solveActive(Aim aim, Optimum &optimum) {
  for (int changes = 0; changes <= mostChanges; ++changes) {
    double change = 1;
    bool isFound = false;
    for (int step = 0; step < mostSteps && !isFound; ++step) {
      if (!newtonStep(aim, optimum, change))
        return false;
      isFound = change <= lastStep && obeysActive(optimum);
    }
    if (!isFound)
      return false;
    Eigen::Index last = 0;
    if (optimum.multiplier.size() > 0 && optimum.multiplier.minCoeff(&last) < -multiplierRounding) {
      optimum.active.erase(optimum.active.begin() + last);
      const Eigen::Index behind = optimum.multiplier.size() - last - 1;
      optimum.multiplier.segment(last, behind) = optimum.multiplier.tail(behind).eval();
      optimum.multiplier.conservativeResize(last + behind);
      continue;
    }
    const int next = mostViolated(optimum);
    if (next < 0)
      return true;
    optimum.active.push_back(next);
    optimum.multiplier.conservativeResize(optimum.multiplier.size() + 1);
    optimum.multiplier[optimum.multiplier.size() - 1] = 0;
  }
  return false;
}

// For x = free + K c:  Kᵀ(∇f − Σ μ ∇s) = 0,  s = common on the active limits; ∇²s = −(I − t tᵀ/‖t‖²)/‖t‖. Of the common slack ∇f = 0 and
// Σ μ = 1. Lengths are relative to the force scale.
bool ConicForces::newtonStep(Aim aim, Optimum &optimum, double &change) {
  const bool common = aim == Aim::CommonSlack;
  const Eigen::Index kernel = kernel_.cols(), first = kernel + (common ? 1 : 0), count = optimum.multiplier.size();
  Eigen::VectorXd &x = optimum.point;
  slope_.setZero(kernel, count);
  optimality_.setZero(first + count, first + count);
  gradient_.setZero(first + count);
  optimality_.diagonal().head(kernel).setConstant(common ? shortest : 1);
  optimality_.diagonal().tail(count).setConstant(dependent);
  for (Eigen::Index a = 0; a < count; ++a) {
    const int k = optimum.active[static_cast<std::size_t>(a)];
    const Limit &limit = limits_[k];
    if (limit.apex >= 0)
      slope_.col(a) = limit.factor * kernelRows_.col(limit.apex);
    gradient_[first + a] = (optimum.common - slack(k, x)) / scale_;
    if (limit.first < 0)
      continue;
    const double one = x[limit.first], other = limit.second >= 0 ? x[limit.second] : 0, length = std::hypot(one, other);
    if (!(length > 0))
      return false;
    slope_.col(a) -= one / length * kernelRows_.col(limit.first);
    if (limit.second < 0)
      continue;
    slope_.col(a) -= other / length * kernelRows_.col(limit.second);
    across_ = (one * kernelRows_.col(limit.second) - other * kernelRows_.col(limit.first)) / length;
    const double curvature = std::max(optimum.multiplier[a], 0.0) * scale_ / length;
    optimality_.topLeftCorner(kernel, kernel).noalias() += curvature * across_ * across_.transpose();
  }
  gradient_.head(kernel).noalias() = slope_ * optimum.multiplier;
  if (common) {
    gradient_[kernel] = 1 - optimum.multiplier.sum();
    optimality_.row(kernel).tail(count).setOnes();
    optimality_.col(kernel).tail(count).setConstant(-1);
  } else {
    gradient_.head(kernel).noalias() -= kernelRows_ * x / scale_;
  }
  optimality_.topRightCorner(kernel, count) = -slope_;
  optimality_.bottomLeftCorner(count, kernel) = slope_.transpose();
  optimalityFactor_.compute(optimality_);
  step_ = optimalityFactor_.solve(gradient_);
  if (!step_.allFinite())
    return false;
  x.noalias() += scale_ * (kernel_ * step_.head(kernel));
  if (common)
    optimum.common += scale_ * step_[kernel];
  optimum.multiplier += step_.tail(count);
  change = step_.head(first).lpNorm<Eigen::Infinity>();
  return true;
}

}  // namespace tf::runtime
