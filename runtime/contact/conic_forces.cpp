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
// Weights from which it is tried to end with the active limits: the first one, and what parts each from the next one.
constexpr double firstTrial = 1e-4, betweenTrials = 1e-3;

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

bool ConicForces::prepare(double tolerance, double leastScale) {
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
  scale_ = std::max(free_.lpNorm<Eigen::Infinity>(), leastScale);
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

// From the last one, if there is one, on the equations as they are now.
bool ConicForces::follow(Aim aim, Optimum &optimum) {
  if (!optimum.isKnown || optimum.point.size() != free_.size() || kernel_.cols() == 0)
    return false;
  unknown_ = kernel_.transpose() * (optimum.point - free_);
  optimum.point = free_ + kernel_ * unknown_;
  optimum.isKnown = solveActive(aim, optimum);
  return optimum.isKnown;
}

// From unknown_, in the inside of the domain, along the barrier's central path; from some of its points the active limits may lead to the
// optimum. Where they do not, as where a slack has no derivative there, the path's end remains.
void ConicForces::approach(Aim aim, Optimum &optimum) {
  const bool common = aim == Aim::CommonSlack;
  const Eigen::Index kernel = kernel_.cols();
  const double unit = common ? scale_ : scale_ * scale_;
  optimum.isKnown = false;
  // Equations of full rank have one solution.
  if (kernel == 0) {
    optimum.point = base_;
    return;
  }
  // Within weight·parameter of the optimum.
  const auto parameter = static_cast<double>(2 * limits_.size() + 1);
  double tried = firstTrial;
  for (double weight = firstWeight; weight >= lastWeight; weight *= reduction) {
    center(aim, weight * unit);
    optimum.point = base_ + kernel_ * unknown_.head(kernel);
    optimum.common = common ? smallestSlack(optimum.point) : 0;
    if (weight <= tried) {
      tried = weight * betweenTrials;
      trial_ = optimum;
      findActive(weight, trial_);
      if (solveActive(aim, trial_)) {
        optimum = trial_;
        optimum.isKnown = true;
        return;
      }
    }
    if (common && parameter * weight * scale_ <= slackAccuracy * optimum.common)
      return;
  }
}

double ConicForces::largestSlack() {
  findKernel();
  if (!follow(Aim::CommonSlack, innermost_)) {
    const Eigen::Index kernel = kernel_.cols();
    base_ = free_;
    unknown_.setZero(kernel + 1);
    unknown_[kernel] = smallestSlack(free_) - scale_;
    approach(Aim::CommonSlack, innermost_);
  }
  return smallestSlack(innermost_.point);
}

const Eigen::VectorXd &ConicForces::leastNorm() {
  findKernel();
  base_ = free_;
  unknown_ = kernel_.transpose() * (innermost_.point - free_);
  approach(Aim::LeastNorm, least_);
  return least_.point;
}

const Eigen::VectorXd *ConicForces::followLeastNorm() {
  findKernel();
  return follow(Aim::LeastNorm, least_) ? &least_.point : nullptr;
}

}  // namespace tf::runtime
