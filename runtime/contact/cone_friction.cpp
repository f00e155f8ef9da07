#include "runtime/contact/cone_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

constexpr int newtonLimit = 60, sweepLimit = 400, homotopySteps = 10;
// Pivots below, relative to the largest, are those of redundant contacts: the step is the shortest one.
constexpr double singularStep = 1e-11;

}  // namespace

void ConeFrictionProblem::resize(int normals, int tangents) {
  PlanarFrictionProblem::resize(normals, tangents);
  partner.assign(tangents, -1);
}

// Rows are divided by √D_rr, the two rows of a pair by a common number, so that the disk stays one.
void ConeFrictionSolver::scale() {
  const int n = problem_.normalCount, m = problem_.tangentCount, count = n + m;
  metric_.resize(count);
  for (int r = 0; r < count; ++r) {
    double diagonal = problem_.delassus(r, r);
    if (r >= n && problem_.partner[r - n] >= 0) {
      const int other = n + problem_.partner[r - n];
      diagonal = 0.5 * (diagonal + problem_.delassus(other, other));
    }
    metric_[r] = diagonal > 0 ? std::sqrt(diagonal) : 1.0;
  }
  delassus_.resize(count, count);
  bias_.resize(count);
  magnitude_ = 0;
  for (int r = 0; r < count; ++r) {
    bias_[r] = problem_.bias[r] / metric_[r];
    magnitude_ = std::max(magnitude_, std::abs(bias_[r]));
    for (int c = 0; c < count; ++c)
      delassus_(r, c) = problem_.delassus(r, c) / (metric_[r] * metric_[c]);
  }
  upper_.resize(n);
  for (int i = 0; i < n; ++i) {
    upper_[i] = problem_.upper[i] * metric_[i];
    if (std::isfinite(upper_[i]))
      magnitude_ = std::max(magnitude_, std::abs(upper_[i]));
  }
  friction_.resize(m);
  offset_.resize(m);
  for (int j = 0; j < m; ++j) {
    const int i = problem_.owner[j];
    friction_[j] = i >= 0 ? problem_.friction[j] * metric_[n + j] / metric_[i] : 0.0;
    offset_[j] = problem_.offset[j] * metric_[n + j];
    magnitude_ = std::max(magnitude_, std::abs(offset_[j]));
  }
  if (!(magnitude_ > 0))
    magnitude_ = 1;
  residual_.resize(count);
  jacobian_.resize(count, count);
  pressing_.resize(n);
  pressingSlope_.resize(n, count);
}

void ConeFrictionSolver::normalResidual(int i, double force, double acceleration, bool derivatives) {
  const NormalKind kind = problem_.normalKind[i];
  const double p = force - acceleration;
  const bool inside = kind == NormalKind::Bilateral || (kind == NormalKind::Unilateral && p > 0 && p < upper_[i]);
  pressing_[i] = kind == NormalKind::Prescribed ? upper_[i] : kind == NormalKind::Bilateral ? force : std::clamp(p, 0.0, upper_[i]);
  residual_[i] = inside ? acceleration : force - pressing_[i];
  if (!derivatives)
    return;
  jacobian_.row(i).setZero();
  pressingSlope_.row(i).setZero();
  if (!inside) {
    jacobian_(i, i) = 1;
    return;
  }
  jacobian_.row(i) = delassus_.row(i);
  pressingSlope_(i, i) = 1;
  if (kind == NormalKind::Unilateral)
    pressingSlope_.row(i) -= delassus_.row(i);
}

double ConeFrictionSolver::limit(int j) const {
  const int i = problem_.owner[j];
  return std::max(0.0, offset_[j] + (i >= 0 ? frictionFactor_ * friction_[j] * pressing_[i] : 0.0));
}

void ConeFrictionSolver::tangentResidual(int j, const Eigen::VectorXd &force, const Eigen::VectorXd &acceleration, bool derivatives) {
  const int r = problem_.normalCount + j, i = problem_.owner[j];
  const double bound = limit(j), p = force[r] - acceleration[r], sign = problem_.sign[j];
  double side = 0;  // λ = side·bound, or w = 0
  bool active = false;
  switch (problem_.tangentKind[j]) {
  case TangentKind::None:
    break;
  case TangentKind::Slip:
    side = -sign;
    break;
  case TangentKind::Bilateral:
    active = true;
    break;
  case TangentKind::TwoSided:
    active = std::abs(p) < bound;
    side = p > 0 ? 1 : -1;
    break;
  case TangentKind::OneSided:
    active = sign * p < bound;
    side = sign;
    break;
  }
  residual_[r] = active ? acceleration[r] : force[r] - side * bound;
  if (!derivatives)
    return;
  if (active) {
    jacobian_.row(r) = delassus_.row(r);
    return;
  }
  jacobian_.row(r).setZero();
  jacobian_(r, r) = 1;
  if (i >= 0 && bound > 0)
    jacobian_.row(r) -= side * frictionFactor_ * friction_[j] * pressingSlope_.row(i);
}

// F = λ − P(p), p = λ − w; dP = dL p/‖p‖ + L/‖p‖ (I − p pᵀ/‖p‖²) dp outside the disk of radius L.
void ConeFrictionSolver::diskResidual(int j, const Eigen::VectorXd &force, const Eigen::VectorXd &acceleration, bool derivatives) {
  const int a = problem_.normalCount + j, i = problem_.owner[j];
  const double bound = limit(j);
  const Eigen::Vector2d p = force.segment<2>(a) - acceleration.segment<2>(a);
  const double length = p.norm();
  if (length <= bound) {
    residual_.segment<2>(a) = acceleration.segment<2>(a);
    if (derivatives)
      jacobian_.middleRows<2>(a) = delassus_.middleRows<2>(a);
    return;
  }
  const Eigen::Vector2d direction = p / length;
  residual_.segment<2>(a) = force.segment<2>(a) - bound * direction;
  if (!derivatives)
    return;
  const Eigen::Matrix2d turn = bound / length * (Eigen::Matrix2d::Identity() - direction * direction.transpose());
  jacobian_.middleRows<2>(a) = turn * delassus_.middleRows<2>(a);
  jacobian_.block<2, 2>(a, a) += Eigen::Matrix2d::Identity() - turn;
  if (i >= 0 && bound > 0)
    jacobian_.middleRows<2>(a) -= frictionFactor_ * friction_[j] * direction * pressingSlope_.row(i);
}

void ConeFrictionSolver::residual(const Eigen::VectorXd &force, const Eigen::VectorXd &acceleration, bool derivatives) {
  for (int i = 0; i < problem_.normalCount; ++i)
    normalResidual(i, force[i], acceleration[i], derivatives);
  for (int j = 0; j < problem_.tangentCount; ++j) {
    if (problem_.partner[j] < 0 || problem_.tangentKind[j] != TangentKind::TwoSided)
      tangentResidual(j, force, acceleration, derivatives);
    else if (problem_.partner[j] > j)
      diskResidual(j, force, acceleration, derivatives);
  }
}

double ConeFrictionSolver::size(const Eigen::VectorXd &force) const {
  return residual_.lpNorm<Eigen::Infinity>() / (magnitude_ + 1e-5 * force.lpNorm<Eigen::Infinity>());
}

// Semismooth Newton steps, shortened where the residual grows, down to rounding; the violation that is reached.
double ConeFrictionSolver::improve(Eigen::VectorXd &force) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
  factor.setThreshold(singularStep);
  residual(force, delassus_ * force + bias_, true);
  double violation = size(force), norm = residual_.norm();
  int stagnant = 0;
  for (int k = 0; k < newtonLimit && violation > 0; ++k) {
    ++iterations_;
    const Eigen::VectorXd step = -factor.compute(jacobian_).solve(residual_);
    if (!step.allFinite())
      break;
    const Eigen::VectorXd from = force;
    double best = std::numeric_limits<double>::infinity(), bestFactor = 1;
    for (double length = 1; length > 1e-3; length *= 0.5) {
      force = from + length * step;
      residual(force, delassus_ * force + bias_, false);
      if (residual_.norm() < best) {
        best = residual_.norm();
        bestFactor = length;
      }
      if (best <= (1 - 1e-4 * length) * norm)
        break;
    }
    if (violation <= tolerance_ && !(best < 0.5 * norm)) {
      force = from;
      residual(force, delassus_ * force + bias_, false);
      break;
    }
    stagnant = best < 0.99 * norm ? 0 : stagnant + 1;
    if (stagnant > 6)
      break;
    force = from + bestFactor * step;
    residual(force, delassus_ * force + bias_, true);
    violation = size(force);
    norm = residual_.norm();
  }
  return violation;
}

// Projected Gauss–Seidel: each row, or pair of rows, in turn takes the force that its own acceleration asks for.
void ConeFrictionSolver::sweep(Eigen::VectorXd &force, int count) {
  const int n = problem_.normalCount;
  Eigen::VectorXd acceleration = delassus_ * force + bias_;
  const auto relax = [&](int row, int rows) {
    residual(force, acceleration, false);
    // λ − F = P(λ − w) off w = 0, where a step of the size of 1/D_rr takes its place.
    for (int r = row; r < row + rows; ++r) {
      const double change = -residual_[r] * (rows == 2 ? 0.5 : 1);
      force[r] += change;
      acceleration += delassus_.col(r) * change;
    }
  };
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i < n; ++i)
      relax(i, 1);
    for (int j = 0; j < problem_.tangentCount; ++j)
      if (problem_.partner[j] < 0 || problem_.partner[j] > j)
        relax(n + j, problem_.partner[j] < 0 ? 1 : 2);
  }
}

bool ConeFrictionSolver::attempt(Eigen::VectorXd force) {
  const double violation = improve(force);
  if (violation < bestViolation_) {
    bestViolation_ = violation;
    best_ = force;
  }
  return bestViolation_ <= tolerance_;
}

const ConeFrictionSolution &ConeFrictionSolver::solve(const double *guess, double tolerance) {
  const int count = problem_.normalCount + problem_.tangentCount;
  scale();
  tolerance_ = tolerance;
  iterations_ = 0;
  frictionFactor_ = 1;
  bestViolation_ = std::numeric_limits<double>::infinity();
  best_.setZero(count);
  Eigen::VectorXd start = Eigen::VectorXd::Zero(count);
  bool solved = false;
  if (guess != nullptr) {
    for (int r = 0; r < count; ++r)
      start[r] = guess[r] * metric_[r];
    solved = attempt(start);
  }
  if (!solved) {
    start.setZero();
    sweep(start, 20);
    solved = attempt(start);
  }
  if (!solved) {
    sweep(start, sweepLimit);
    solved = attempt(start);
  }
  if (!solved) {
    // Friction grows from none to its size, the solution follows.
    start.setZero();
    for (int k = 0; k <= homotopySteps; ++k) {
      frictionFactor_ = static_cast<double>(k) / homotopySteps;
      if (k < homotopySteps)
        improve(start);
    }
    solved = attempt(start);
  }
  const Eigen::VectorXd acceleration = delassus_ * best_ + bias_;
  solution_.solved = solved;
  solution_.violation = bestViolation_;
  solution_.scale = magnitude_;
  solution_.force.resize(count);
  solution_.acceleration.resize(count);
  for (int r = 0; r < count; ++r) {
    solution_.force[r] = best_[r] / metric_[r];
    solution_.acceleration[r] = acceleration[r] * metric_[r];
  }
  return solution_;
}

double ConeFrictionSolver::certificate(const std::vector<double> &force, const std::vector<double> &acceleration) {
  const int count = problem_.normalCount + problem_.tangentCount;
  Eigen::VectorXd f(count), w(count);
  for (int r = 0; r < count; ++r) {
    f[r] = force[r] * metric_[r];
    w[r] = acceleration[r] / metric_[r];
  }
  frictionFactor_ = 1;
  residual(f, w, false);
  return size(f);
}

}  // namespace tf::runtime
