#include "runtime/contact/conic_forces.h"

#include "runtime/contact/null_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace tf::runtime {

namespace {

// Rows of A have length 1; smaller pivots are those of dependent rows.
constexpr double singular = 1e-9;
// Forces beyond this multiple of the largest one are of no interest: internal forces of wedged bodies may grow without end.
constexpr double farthest = 1e3;
// The barrier's weight falls from firstWeight to lastWeight, relative to the force scale: the result is that far from the optimum.
constexpr double firstWeight = 1, lastWeight = 1e-14, reduction = 0.05;
// Of the largest slack, relative to itself: its zero counts.
constexpr double slackAccuracy = 1e-6;
// Of a least-norm point that is followed, relative to the force scale: slacks below are those of active limits, steps below the last ones,
// and slacks and multipliers may be negative by that much.
constexpr double active = 1e-6, lastStep = 1e-9, multiplierRounding = 1e-13;
constexpr int stepLimit = 8;

}  // namespace

void ConicForces::resize(int variables, int limits) {
  matrix_.resize(variables, variables);
  rhs_.resize(variables);
  limits_.resize(limits);
}

void ConicForces::subtractProduct(const Eigen::VectorXd &x, Eigen::VectorXd &y) const {
  for (Eigen::Index c = 0; c < x.size(); ++c)
    if (x[c] != 0)
      y -= x[c] * matrix_.col(c);
}

void ConicForces::solve(const Eigen::VectorXd &rhs, Eigen::VectorXd &x) const {
  x.setZero(rhs.size());
  for (std::size_t number = 0; number < partition_.count(); ++number) {
    // Aᵀ P = Q R: the first `rank` equations in the order of P are independent.
    Part &part = parts_[number];
    const std::span<const int> places = partition_.rows(number);
    if (std::all_of(places.begin(), places.end(), [&rhs](int place) { return rhs[place] == 0; }))
      continue;
    const Eigen::Index rank = part.factor.rank(), count = part.factor.rows();
    part.values = part.factor.colsPermutation().transpose() * rhs(places);
    part.values.tail(count - rank).setZero();
    part.factor.matrixR()
        .topLeftCorner(rank, rank)
        .template triangularView<Eigen::Upper>()
        .transpose()
        .solveInPlace(part.values.head(rank));
    part.values.applyOnTheLeft(part.factor.householderQ());
    x(places) = part.values;
  }
}

void ConicForces::multipliersOf(const Eigen::VectorXd &x, Eigen::VectorXd &z) const {
  z.resize(x.size());
  for (std::size_t number = 0; number < partition_.count(); ++number) {
    Part &part = parts_[number];
    const std::span<const int> places = partition_.rows(number);
    const Eigen::Index rank = part.factor.rank(), count = part.factor.rows();
    part.values = x(places);
    part.values.applyOnTheLeft(part.factor.householderQ().adjoint());
    part.factor.matrixR().topLeftCorner(rank, rank).template triangularView<Eigen::Upper>().solveInPlace(part.values.head(rank));
    part.values.tail(count - rank).setZero();
    z(places) = part.factor.colsPermutation() * part.values;
  }
}

// An orthonormal basis of the null space of A, part by part.
void ConicForces::findKernel() {
  if (hasKernel_)
    return;
  hasKernel_ = true;
  Eigen::Index count = 0;
  for (std::size_t number = 0; number < partition_.count(); ++number)
    count += parts_[number].factor.rows() - parts_[number].factor.rank();
  kernel_.setZero(rhs_.size(), count);
  Eigen::Index column = 0;
  Eigen::MatrixXd own;
  for (std::size_t number = 0; number < partition_.count(); ++number) {
    findNullSpace(parts_[number].factor, own);
    kernel_(partition_.rows(number), Eigen::seqN(column, own.cols())) = own;
    column += own.cols();
  }
  kernelRows_ = kernel_.transpose();
}

bool ConicForces::prepare(double tolerance) {
  rowLength_ = matrix_.rowwise().norm();
  rowLength_ = (rowLength_.array() > 0).select(rowLength_, 1.0);
  matrix_.array().colwise() /= rowLength_.array();
  rhs_.array() /= rowLength_.array();
  partition_.find(matrix_.data(), static_cast<int>(rhs_.size()));
  if (parts_.size() < partition_.count())
    parts_.resize(partition_.count());
  hasKernel_ = false;
  for (std::size_t number = 0; number < partition_.count(); ++number) {
    const std::span<const int> places = partition_.rows(number);
    parts_[number].factor.setThreshold(singular);
    parts_[number].factor.compute(matrix_(places, places).transpose());
  }
  solve(rhs_, free_);
  scale_ = free_.lpNorm<Eigen::Infinity>();
  for (const Limit &limit : limits_)
    scale_ = std::max(scale_, limit.offset);
  if (!(scale_ > 0))
    scale_ = 1;
  return (matrix_ * free_ - rhs_).lpNorm<Eigen::Infinity>() <= tolerance * scale_;
}

double ConicForces::slack(int k, const Eigen::VectorXd &x) const {
  const Limit &limit = limits_[k];
  const double first = limit.first >= 0 ? x[limit.first] : 0, second = limit.second >= 0 ? x[limit.second] : 0;
  return (limit.apex >= 0 ? limit.factor * x[limit.apex] : 0) + limit.offset - std::hypot(first, second);
}

double ConicForces::smallestSlack(const Eigen::VectorXd &x) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < limits_.size(); ++k)
    least = std::min(least, slack(static_cast<int>(k), x));
  return least;
}

// Objective and barrier −Σ log(u² − ‖t‖²) − log(R² − ‖c‖²), u = slack without ‖t‖ less the common slack, with gradient and Hessian.
// False outside the domain. Of the Hessian the lower triangle is set.
bool ConicForces::barrier(Aim aim, double weight, double &value, bool derivatives) {
  const bool common = aim == Aim::CommonSlack;
  const Eigen::Index kernel = kernel_.cols(), size = kernel + (common ? 1 : 0);
  const auto c = unknown_.head(kernel);
  point_.noalias() = base_ + kernel_ * c;
  const double margin = common ? unknown_[kernel] : 0.0;
  const double radius = farthest * scale_, room = radius * radius - c.squaredNorm();
  if (!(room > 0))
    return false;
  value = (common ? -margin : 0.5 * point_.squaredNorm()) / weight - std::log(room);
  if (derivatives) {
    gradient_.setZero(size);
    hessian_.setZero(size, size);
    if (common)
      gradient_[kernel] = -1 / weight;
    else
      gradient_ = kernel_.transpose() * point_ / weight;
    if (!common)
      hessian_.diagonal().setConstant(1 / weight);  // the kernel's basis is orthonormal
    gradient_.head(kernel) += 2 / room * c;
    hessian_.topLeftCorner(kernel, kernel).diagonal().array() += 2 / room;
    hessian_.topLeftCorner(kernel, kernel).selfadjointView<Eigen::Lower>().rankUpdate(c, 4 / (room * room));
  }
  du_.resize(size);
  logSlope_.resize(size);
  for (const Limit &limit : limits_) {
    const double u = (limit.apex >= 0 ? limit.factor * point_[limit.apex] : 0) + limit.offset - margin;
    const double first = limit.first >= 0 ? point_[limit.first] : 0, second = limit.second >= 0 ? point_[limit.second] : 0;
    const double length = std::hypot(first, second), square = (u - length) * (u + length);
    if (!(u > length))
      return false;
    const bool line = limit.first < 0;
    value -= line ? std::log(u) : std::log(square);
    if (!derivatives)
      continue;
    du_.setZero(size);
    if (limit.apex >= 0)
      du_.head(kernel) = limit.factor * kernelRows_.col(limit.apex);
    if (common)
      du_[kernel] = -1;
    if (line) {
      gradient_ -= du_ / u;
      hessian_.selfadjointView<Eigen::Lower>().rankUpdate(du_, 1 / (u * u));
      continue;
    }
    // d(u² − ‖t‖²) = 2(u du − Σ t dt), second derivative 2(du duᵀ − Σ dt dtᵀ).
    logSlope_ = 2 * u * du_;
    hessian_.selfadjointView<Eigen::Lower>().rankUpdate(du_, -2 / square);
    for (const int t : {limit.first, limit.second}) {
      if (t < 0)
        continue;
      logSlope_.head(kernel) -= 2 * point_[t] * kernelRows_.col(t);
      hessian_.topLeftCorner(kernel, kernel).selfadjointView<Eigen::Lower>().rankUpdate(kernelRows_.col(t), 2 / square);
    }
    gradient_ -= logSlope_ / square;
    hessian_.selfadjointView<Eigen::Lower>().rankUpdate(logSlope_, 1 / (square * square));
  }
  return true;
}

// Newton's method on the barrier function from a point of its domain.
void ConicForces::center(Aim aim, double weight) {
  double value = 0;
  for (int iteration = 0; iteration < 60; ++iteration) {
    if (!barrier(aim, weight, value, true))
      return;
    step_ = hessianFactor_.compute(hessian_).solve(-gradient_);
    const double decrement = -gradient_.dot(step_);
    if (!(decrement > 1e-12) || !step_.allFinite())
      return;
    const Eigen::VectorXd from = unknown_;
    double factor = 1, trial = 0;
    for (;; factor *= 0.5) {
      if (factor < 1e-12) {
        unknown_ = from;
        return;
      }
      unknown_ = from + factor * step_;
      if (barrier(aim, weight, trial, false) && trial <= value - 1e-4 * factor * decrement)
        break;
      // Near the optimum values agree to rounding: a full step of a small decrement is taken.
      if (factor == 1 && decrement < 1e-6 && barrier(aim, weight, trial, false))
        return;
    }
    if (decrement < 1e-3 && factor == 1 && weight > 10 * lastWeight * scale_)
      return;
  }
}

double ConicForces::largestSlack() {
  findKernel();
  const Eigen::Index kernel = kernel_.cols();
  base_ = free_;
  unknown_.setZero(kernel + 1);
  unknown_[kernel] = smallestSlack(free_) - scale_;
  double largest = -std::numeric_limits<double>::infinity();
  // Within weight·parameter of the optimum.
  const auto parameter = static_cast<double>(2 * limits_.size() + 1);
  for (double weight = firstWeight; weight >= lastWeight && !(parameter * weight * scale_ <= slackAccuracy * largest);
       weight *= reduction) {
    center(Aim::CommonSlack, weight * scale_);
    innermost_ = base_ + kernel_ * unknown_.head(kernel);
    largest = smallestSlack(innermost_);
  }
  return largest;
}

const Eigen::VectorXd &ConicForces::leastNorm() {
  findKernel();
  const Eigen::Index kernel = kernel_.cols();
  base_ = free_;
  unknown_ = kernel_.transpose() * (innermost_ - free_);
  unknown_.conservativeResize(kernel);
  for (double weight = firstWeight; weight >= lastWeight; weight *= reduction)
    center(Aim::LeastNorm, weight * scale_ * scale_);
  least_ = base_ + kernel_ * unknown_;
  // To rounding, as the points that follow; in a thin set, whose limits have dependent slopes, Newton's steps may lead anywhere.
  point_ = least_;
  findActive();
  if (followLeastNorm() == nullptr) {
    least_ = point_;
    isKnown_ = false;
  }
  return least_;
}

// The limits that are active at `least_`, and their multipliers.
void ConicForces::findActive() {
  active_.clear();
  for (std::size_t k = 0; k < limits_.size(); ++k)
    if (slack(static_cast<int>(k), least_) <= active * scale_)
      active_.push_back(static_cast<int>(k));
  multiplier_.setZero(static_cast<Eigen::Index>(active_.size()));
  isKnown_ = true;
  double ignored = 0;
  if (!newtonStep(ignored))
    isKnown_ = false;
}

// One step of Newton's method for x = free + K c:  Kᵀ(x − Σ μ ∇s) = 0,  s = 0 on the active limits; ∇²s = −(I − t tᵀ/‖t‖²)/‖t‖.
bool ConicForces::newtonStep(double &change) {
  const Eigen::Index kernel = kernel_.cols(), count = multiplier_.size(), size = kernel + count;
  slope_.setZero(kernel, count);
  optimality_.setZero(size, size);
  gradient_.setZero(size);
  optimality_.topLeftCorner(kernel, kernel).setIdentity();
  for (Eigen::Index a = 0; a < count; ++a) {
    const int k = active_[static_cast<std::size_t>(a)];
    const Limit &limit = limits_[k];
    if (limit.apex >= 0)
      slope_.col(a) = limit.factor * kernel_.row(limit.apex).transpose();
    gradient_[kernel + a] = -slack(k, least_);
    if (limit.first < 0)
      continue;
    const double first = least_[limit.first], second = limit.second >= 0 ? least_[limit.second] : 0, length = std::hypot(first, second);
    if (!(length > 0))
      return false;
    slope_.col(a) -= first / length * kernel_.row(limit.first).transpose();
    if (limit.second < 0)
      continue;
    slope_.col(a) -= second / length * kernel_.row(limit.second).transpose();
    across_ = (first * kernel_.row(limit.second) - second * kernel_.row(limit.first)).transpose() / length;
    optimality_.topLeftCorner(kernel, kernel).noalias() += multiplier_[a] / length * across_ * across_.transpose();
  }
  gradient_.head(kernel).noalias() = slope_ * multiplier_ - kernel_.transpose() * least_;
  optimality_.topRightCorner(kernel, count) = -slope_;
  optimality_.bottomLeftCorner(count, kernel) = slope_.transpose();
  optimalityFactor_.compute(optimality_);
  step_ = optimalityFactor_.solve(gradient_);
  if (!step_.allFinite())
    return false;
  least_.noalias() += kernel_ * step_.head(kernel);
  multiplier_ += step_.tail(count);
  change = step_.head(kernel).lpNorm<Eigen::Infinity>() / scale_;
  return true;
}

const Eigen::VectorXd *ConicForces::followLeastNorm() {
  if (!isKnown_ || least_.size() != free_.size())
    return nullptr;
  isKnown_ = false;
  findKernel();
  // The last point on the new equations.
  unknown_ = kernel_.transpose() * (least_ - free_);
  least_ = free_ + kernel_ * unknown_;
  const Eigen::Index count = multiplier_.size();
  double change = 1;
  for (int k = 0; k < stepLimit && change > lastStep; ++k)
    if (!newtonStep(change))
      return nullptr;
  if (change > lastStep || (count > 0 && multiplier_.minCoeff() < -multiplierRounding * multiplier_.maxCoeff()) ||
      smallestSlack(least_) < -multiplierRounding * scale_)
    return nullptr;
  isKnown_ = true;
  return &least_;
}

}  // namespace tf::runtime
