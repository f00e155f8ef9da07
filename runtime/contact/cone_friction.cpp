#include "runtime/contact/cone_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace tf::runtime {

namespace {

constexpr int newtonLimit = 60, sweepLimit = 400, homotopySteps = 10;
// Pivots below, relative to the largest, are those of redundant contacts: the step is the shortest one.
constexpr double singularStep = 1e-11;
// Without pivots below, relative to the largest entry, none are redundant.
constexpr double regularStep = 1e-8;
// Of followSmoothing: relative to the scale of forces, and of D.
constexpr double lastSmoothing = 1e-14, smoothingReduction = 0.1;
constexpr int smoothedLimit = 12;
constexpr int scatteredStarts = 20, wanderLimit = 40;

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
  magnitude_ = solution_.scale = 0;
  for (int r = 0; r < count; ++r) {
    bias_[r] = problem_.bias[r] / metric_[r];
    magnitude_ = std::max(magnitude_, std::abs(bias_[r]));
    solution_.scale = std::max(solution_.scale, problem_.weight(r) * std::abs(bias_[r]));
    for (int c = 0; c < count; ++c)
      delassus_(r, c) = problem_.delassus(r, c) / (metric_[r] * metric_[c]);
  }
  upper_.resize(n);
  for (int i = 0; i < n; ++i) {
    upper_[i] = problem_.upper[i] * metric_[i];
    if (std::isfinite(upper_[i]))
      solution_.scale = std::max(solution_.scale, std::abs(upper_[i]));
  }
  friction_.resize(m);
  offset_.resize(m);
  for (int j = 0; j < m; ++j) {
    const int i = problem_.owner[j];
    friction_[j] = i >= 0 ? problem_.friction[j] * metric_[n + j] / metric_[i] : 0.0;
    offset_[j] = problem_.offset[j] * metric_[n + j];
    solution_.scale = std::max(solution_.scale, std::abs(offset_[j]));
  }
  magnitude_ = std::max(magnitude_, solution_.scale);
  if (!(magnitude_ > 0))
    magnitude_ = solution_.scale = 1;
  residual_.resize(count);
  jacobian_.resize(count, count);
  pressing_.resize(n);
  pressingSlope_.resize(n, count);
}

// The positive part, smoothed (Chen, Harker, Kanzow and Smale), and its slope: ½(x + √(x² + 4σ²)).
double ConeFrictionSolver::positivePart(double x, double &slope) const {
  const double root = std::hypot(x, 2 * smoothing_);
  slope = root > 0 ? 0.5 * (1 + x / root) : 0.0;
  return x > 0 ? 0.5 * (x + root) : smoothing_ > 0 ? 2 * smoothing_ * smoothing_ / (root - x) : 0.0;
}

void ConeFrictionSolver::normalResidual(int i, double force, double acceleration, bool derivatives) {
  const NormalKind kind = problem_.normalKind[i];
  double slope = 1;  // dP/dp
  if (kind == NormalKind::Prescribed) {
    pressing_[i] = upper_[i];
    slope = 0;
  } else if (kind == NormalKind::Bilateral) {
    pressing_[i] = force;
  } else {
    const double p = force - acceleration;
    double above = 0;
    pressing_[i] = positivePart(p, slope);
    if (std::isfinite(upper_[i]))
      pressing_[i] -= positivePart(p - upper_[i], above);
    slope -= above;
  }
  const bool inside = kind == NormalKind::Bilateral || (slope == 1 && smoothing_ == 0);
  residual_[i] = inside ? acceleration : force - pressing_[i];
  if (!derivatives)
    return;
  pressingSlope_.row(i) = -slope * response_.row(i);
  pressingSlope_(i, i) += slope;
  if (kind == NormalKind::Bilateral) {
    jacobian_.row(i) = response_.row(i);
    pressingSlope_.row(i).setZero();
    pressingSlope_(i, i) = 1;
    return;
  }
  jacobian_.row(i) = -pressingSlope_.row(i);
  jacobian_(i, i) += 1;
}

// Where normal forces are held they may be rates, which have any sign, and so have those of the friction that follows them.
double ConeFrictionSolver::limit(int j) const {
  const int i = problem_.owner[j];
  const double bound = offset_[j] + (i >= 0 ? frictionFactor_ * friction_[j] * pressing_[i] : 0.0);
  return problem_.tangentKind[j] == TangentKind::TwoSided ? std::max(0.0, bound) : bound;
}

// The projection of p on ‖λ‖ ≤ L: L p/max(‖p‖, L), with the maximum smoothed. Derivative by p: factor·(I − shrink·p pᵀ/‖p‖²), by L: rise·p.
ConeFrictionSolver::DiskProjection ConeFrictionSolver::projectOnDisk(double length, double bound) const {
  DiskProjection projection;
  double slope = 0;
  const double largest = bound + positivePart(length - bound, slope);
  if (!(largest > 0))
    return projection;
  projection.isInside = smoothing_ == 0 && length <= bound;
  projection.factor = bound / largest;
  projection.shrink = slope * length / largest;
  projection.rise = (1 - bound * (1 - slope) / largest) / largest;
  return projection;
}

void ConeFrictionSolver::tangentResidual(int j, const Eigen::VectorXd &force, const Eigen::VectorXd &acceleration, bool derivatives) {
  const int r = problem_.normalCount + j, i = problem_.owner[j];
  const double bound = limit(j), p = force[r] - acceleration[r], sign = problem_.sign[j];
  double projected = 0, byForce = 0, byBound = 0;
  bool inside = false;
  switch (problem_.tangentKind[j]) {
  case TangentKind::None:
    break;
  case TangentKind::Slip:
    projected = -sign * bound;
    byBound = -sign;
    break;
  case TangentKind::Bilateral:
    inside = true;
    break;
  case TangentKind::TwoSided: {
    const DiskProjection disk = projectOnDisk(std::abs(p), bound);
    projected = disk.factor * p;
    byForce = disk.factor * (1 - disk.shrink);
    byBound = disk.rise * p;
    inside = disk.isInside;
    break;
  }
  case TangentKind::OneSided: {
    double beyond = 0;
    projected = p - sign * positivePart(sign * p - bound, beyond);
    byForce = 1 - beyond;
    byBound = sign * beyond;
    inside = smoothing_ == 0 && sign * p < bound;
    break;
  }
  }
  residual_[r] = inside ? acceleration[r] : force[r] - projected;
  if (!derivatives)
    return;
  if (inside) {
    jacobian_.row(r) = response_.row(r);
    return;
  }
  jacobian_.row(r) = byForce * response_.row(r);
  jacobian_(r, r) += 1 - byForce;
  if (i >= 0 && (bound > 0 || problem_.tangentKind[j] != TangentKind::TwoSided))
    jacobian_.row(r) -= byBound * frictionFactor_ * friction_[j] * pressingSlope_.row(i);
}

void ConeFrictionSolver::diskResidual(int j, const Eigen::VectorXd &force, const Eigen::VectorXd &acceleration, bool derivatives) {
  const int a = problem_.normalCount + j, i = problem_.owner[j];
  const double bound = limit(j);
  const Eigen::Vector2d p = force.segment<2>(a) - acceleration.segment<2>(a);
  const double length = p.norm();
  const DiskProjection disk = projectOnDisk(length, bound);
  if (disk.isInside) {
    residual_.segment<2>(a) = acceleration.segment<2>(a);
    if (derivatives)
      jacobian_.middleRows<2>(a) = response_.middleRows<2>(a);
    return;
  }
  residual_.segment<2>(a) = force.segment<2>(a) - disk.factor * p;
  if (!derivatives)
    return;
  Eigen::Matrix2d byForce = disk.factor * Eigen::Matrix2d::Identity();
  if (length > 0)
    byForce -= disk.factor * disk.shrink / (length * length) * p * p.transpose();
  jacobian_.middleRows<2>(a) = byForce * response_.middleRows<2>(a);
  jacobian_.block<2, 2>(a, a) += Eigen::Matrix2d::Identity() - byForce;
  if (i >= 0 && bound > 0)
    jacobian_.middleRows<2>(a) -= frictionFactor_ * friction_[j] * disk.rise * p * pressingSlope_.row(i);
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

// −J⁻¹ F; where contacts are redundant the shortest one.
Eigen::VectorXd ConeFrictionSolver::newtonStep() {
  factor_.matrix().resize(static_cast<int>(jacobian_.rows()), static_cast<int>(jacobian_.cols()));
  factor_.matrix().map() = jacobian_;
  if (factor_.factor(regularStep * jacobian_.lpNorm<Eigen::Infinity>())) {
    Eigen::VectorXd step = -residual_;
    factor_.solve(step.data());
    return step;
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
  factor.setThreshold(singularStep);
  return -factor.compute(jacobian_).solve(residual_);
}

// The part of the step, halved down to `shortest`, behind which the residual's norm falls; where it never does, that where it is least.
ConeFrictionSolver::LineSearch ConeFrictionSolver::shorten(const Eigen::VectorXd &from, const Eigen::VectorXd &step, double norm,
                                                           double shortest) {
  LineSearch found{1, std::numeric_limits<double>::infinity()};
  for (double length = 1; length > shortest; length *= 0.5) {
    const Eigen::VectorXd force = from + length * step;
    residual(force, response_ * force + bias_, false);
    if (residual_.norm() < found.norm)
      found = {length, residual_.norm()};
    if (found.norm <= (1 - 1e-4 * length) * norm)
      break;
  }
  return found;
}

// Semismooth Newton steps, shortened where the residual grows, down to rounding; the violation that is reached.
double ConeFrictionSolver::improve(Eigen::VectorXd &force) {
  residual(force, delassus_ * force + bias_, true);
  double violation = size(force), norm = residual_.norm();
  int stagnant = 0;
  for (int k = 0; k < newtonLimit && violation > 0; ++k) {
    ++iterations_;
    const Eigen::VectorXd step = newtonStep();
    if (!step.allFinite())
      break;
    const LineSearch found = shorten(force, step, norm, 1e-3);
    if (violation <= tolerance_ && !(found.norm < 0.5 * norm))
      break;
    stagnant = found.norm < 0.99 * norm ? 0 : stagnant + 1;
    if (stagnant > 6)
      break;
    force += found.length * step;
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
  const auto give = [&](int row, int rows) {
    // λ − F = P(λ − w) off w = 0, where a step of the size of 1/D_rr takes its place.
    for (int r = row; r < row + rows; ++r) {
      const double change = -residual_[r] * (rows == 2 ? 0.5 : 1);
      if (change == 0)
        continue;
      force[r] += change;
      acceleration += delassus_.col(r) * change;
    }
  };
  for (int k = 0; k < count; ++k) {
    for (int i = 0; i < n; ++i) {
      normalResidual(i, force[i], acceleration[i], false);
      give(i, 1);
    }
    for (int j = 0; j < problem_.tangentCount; ++j) {
      const int owner = problem_.owner[j];
      const bool pair = problem_.partner[j] >= 0 && problem_.tangentKind[j] == TangentKind::TwoSided;
      if (pair && problem_.partner[j] < j)
        continue;
      // The limit is that of the normal force at this point.
      if (owner >= 0)
        normalResidual(owner, force[owner], acceleration[owner], false);
      if (pair)
        diskResidual(j, force, acceleration, false);
      else
        tangentResidual(j, force, acceleration, false);
      give(n + j, pair ? 2 : 1);
    }
  }
}

void ConeFrictionSolver::setSmoothing(double smoothing) {
  smoothing_ = smoothing * magnitude_;
  response_ = delassus_;
  response_.diagonal().array() += smoothing;
}

// Newton's method for equations that are smoothed and regularised, the less the nearer it comes to their solution (Hayashi, Yamashita and
// Fukushima, SIAM Journal on Optimization 15, 2005): also where forces are not unique.
bool ConeFrictionSolver::followSmoothing() {
  const int count = static_cast<int>(residual_.size());
  Eigen::VectorXd force = Eigen::VectorXd::Zero(count), step(count);
  Eigen::PartialPivLU<Eigen::MatrixXd> factor(count);
  for (double smoothing = 1; smoothing > lastSmoothing; smoothing *= smoothingReduction) {
    setSmoothing(smoothing);
    residual(force, response_ * force + bias_, true);
    for (int k = 0; k < smoothedLimit && residual_.norm() > 0.1 * smoothing_; ++k) {
      ++iterations_;
      step = -factor.compute(jacobian_).solve(residual_);
      if (!step.allFinite())
        break;
      force += shorten(force, step, residual_.norm(), 1e-4).length * step;
      residual(force, response_ * force + bias_, true);
    }
    setSmoothing(0);
    residual(force, response_ * force + bias_, false);
    if (const double violation = size(force); violation < bestViolation_) {
      bestViolation_ = violation;
      best_ = force;
    } else if (bestViolation_ <= tolerance_) {
      break;
    }
  }
  setSmoothing(0);
  return bestViolation_ <= tolerance_;
}

bool ConeFrictionSolver::attempt(Eigen::VectorXd force) {
  const double violation = improve(force);
  if (violation < bestViolation_) {
    bestViolation_ = violation;
    best_ = force;
  }
  return bestViolation_ <= tolerance_;
}

// From forces with which some of the contacts stay at rest and the others are open: where friction holds what would slide without it, other
// methods go past a solution in which nothing moves.
bool ConeFrictionSolver::attemptRest() {
  constexpr int mostContacts = 6;
  const int n = problem_.normalCount, count = n + problem_.tangentCount;
  std::vector<int> contacts;
  for (int i = 0; i < n; ++i)
    if (problem_.normalKind[i] == NormalKind::Unilateral)
      contacts.push_back(i);
  const int bits = std::min(static_cast<int>(contacts.size()), mostContacts);
  std::vector<std::uint8_t> rests(static_cast<std::size_t>(n), 0);
  std::vector<int> rows;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor;
  factor.setThreshold(singularStep);
  for (int open = 0; open < (1 << bits); ++open) {
    for (std::size_t k = 0; k < contacts.size(); ++k)
      rests[contacts[k]] = static_cast<int>(k) >= bits || ((open >> k) & 1) == 0;
    rows.clear();
    for (int r = 0; r < count; ++r) {
      const int contact = r < n ? r : problem_.owner[r - n];
      const bool free = r < n || problem_.tangentKind[r - n] == TangentKind::TwoSided;
      if (free && contact >= 0 && rests[contact])
        rows.push_back(r);
    }
    if (rows.empty())
      continue;
    const Eigen::MatrixXd D = delassus_(rows, rows);
    Eigen::VectorXd start = Eigen::VectorXd::Zero(count);
    const Eigen::VectorXd rest = factor.compute(D).solve(-bias_(rows).eval());
    start(rows) = rest;
    if (attempt(std::move(start)))
      return true;
  }
  return false;
}

// Newton steps that go on, by a random part of themselves, where none of their parts makes the residual smaller: many pieces of the
// equations meet in such a point, and a solution lies in one of them. Bounded forces have one always (Kakutani's theorem), however the
// residual lies in between.
void ConeFrictionSolver::wander(Eigen::VectorXd &force, const std::function<double()> &random) {
  constexpr double shortest = 0.02, falls = 0.999;
  residual(force, delassus_ * force + bias_, true);
  double norm = residual_.norm();
  for (int k = 0; k < wanderLimit && size(force) > tolerance_; ++k) {
    ++iterations_;
    const Eigen::VectorXd step = newtonStep();
    if (!step.allFinite())
      break;
    const LineSearch found = shorten(force, step, norm, shortest);
    force += (found.norm < falls * norm ? found.length : random()) * step;
    residual(force, delassus_ * force + bias_, true);
    norm = residual_.norm();
  }
}

// From forces anywhere within their limits, or of the size of the data: always the same ones, so that the same problem has the same
// solution.
bool ConeFrictionSolver::attemptScattered() {
  const int n = problem_.normalCount, m = problem_.tangentCount;
  std::minstd_rand generator;
  const auto random = [&generator] { return static_cast<double>(generator()) / std::minstd_rand::max(); };
  Eigen::VectorXd force(n + m);
  for (int k = 0; k < scatteredStarts; ++k) {
    for (int i = 0; i < n; ++i)
      force[i] = random() * (std::isfinite(upper_[i]) ? upper_[i] : magnitude_);
    for (int j = 0; j < m; ++j)
      force[n + j] = (random() - 0.5) * magnitude_;
    wander(force, random);
    if (attempt(force))
      return true;
  }
  return false;
}

const ConeFrictionSolution &ConeFrictionSolver::solve(const double *guess, double tolerance) {
  const int count = problem_.normalCount + problem_.tangentCount;
  scale();
  tolerance_ = tolerance;
  iterations_ = 0;
  frictionFactor_ = 1;
  setSmoothing(0);
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
  if (!solved && followSmoothing())
    solved = attempt(best_);
  if (!solved) {
    // Friction grows from none to its size, the solution follows.
    start.setZero();
    for (int k = 0; k <= homotopySteps; ++k) {
      frictionFactor_ = static_cast<double>(k) / homotopySteps;
      if (k < homotopySteps)
        improve(start);
    }
    solved = attempt(start) || attemptRest() || attemptScattered();
  }
  const Eigen::VectorXd acceleration = delassus_ * best_ + bias_;
  solution_.solved = solved;
  solution_.violation = bestViolation_;
  solution_.scale = std::max({solution_.scale, finestScale(bestViolation_, magnitude_), best_.lpNorm<Eigen::Infinity>()});
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
  setSmoothing(0);
  residual(f, w, false);
  return size(f);
}

}  // namespace tf::runtime
