#include "runtime/contact/frozen_mode.h"

#include "runtime/contact/frame_turns.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Pivots below, relative to the largest entry of D, are those of redundant rows.
constexpr double singular = 1e-11;
// Margins to limits below, relative to the rates, are none.
constexpr double leastMargin = 1e-9;

}  // namespace

void FrozenMode::resize(const FrozenProblem &problem) {
  const int n = problem.normalCount, m = problem.tangentCount;
  normal.assign(n, Normal::Off);
  tangent.assign(m, Tangent::None);
  sign.assign(m, 0);
  direction.assign(m, 0.0);
  for (int j = 0; j < m; ++j)
    direction[j] = problem.partner[j] > j ? 1.0 : 0.0;
  current_ = direction;
  posed_ = false;
  offset_.assign(m, 0.0);
  bias_.assign(n + m, 0.0);
  fixed_.assign(n, 0.0);
  nearby_.assign(n + m, 0.0);
  redundant_ = false;
  active_.assign(n + m, 0);
  slip_.assign(m, 0);
}

void FrozenMode::setTangent(const FrozenProblem &problem, int j, Tangent kind, int slipSign) {
  const int rows = problem.partner[j] > j ? 2 : 1;
  for (int k = j; k < j + rows; ++k) {
    tangent[k] = kind;
    sign[k] = slipSign;
  }
}

void FrozenMode::setDirection(int j, double x, double y) {
  const double length = std::hypot(x, y);
  if (!(length > 0))
    return;
  direction[j] = x / length;
  direction[j + 1] = y / length;
}

void FrozenMode::turn(const FrozenProblem &problem, DenseMatrix &delassus) const {
  delassus = problem.delassus;
  for (int j = 0; j < problem.tangentCount; ++j)
    if (problem.partner[j] > j)
      turnRows(delassus, problem.normalCount + j, direction[j], direction[j + 1]);
}

void FrozenMode::turnForces(const FrozenProblem &problem, double sense, std::vector<double> &forces) const {
  for (int j = 0; j < problem.tangentCount; ++j) {
    if (problem.partner[j] < j)
      continue;
    const int row = problem.normalCount + j;
    turnVector(forces[row], forces[row + 1], direction[j], sense * direction[j + 1]);
  }
}

void FrozenMode::ActiveFactor::factor() {
  matrix = regular.matrix().map();
  const double largest = matrix.size() > 0 ? std::max(matrix.diagonal().maxCoeff(), 0.0) : 0.0;
  isSingular = matrix.size() > 0 && !regular.factor(singular * largest);
  if (!isSingular)
    return;
  decomposition.setThreshold(singular);
  decomposition.compute(matrix);
}

void FrozenMode::ActiveFactor::solve(Eigen::VectorXd &x) const {
  if (isSingular)
    x = decomposition.solve(x).eval();
  else if (x.size() > 0)
    regular.solve(x.data());
}

void FrozenMode::ActiveFactor::solveNear(const Eigen::VectorXd &reference, Eigen::VectorXd &x) const {
  if (!isSingular)
    return solve(x);
  x -= matrix * reference;
  solve(x);
  x += reference;
}

Eigen::VectorXd FrozenMode::nearbyForces(const ModeEquations &equations) const {
  Eigen::VectorXd forces(equations.activeCount());
  for (int k = 0; k < equations.activeCount(); ++k)
    forces[k] = nearby_[equations.active()[k]];
  return forces;
}

// Of friction on the pairs that slip: v_t/‖v_t‖ continued through zero along the reference direction.
void FrozenMode::turnDirections(const FrozenProblem &problem, const std::vector<double> &velocity, double rest) {
  const int n = problem.normalCount;
  for (int j = 0; j < problem.tangentCount; ++j) {
    if (problem.partner[j] < j || tangent[j] != Tangent::Slip)
      continue;
    const double c = direction[j], s = direction[j + 1];
    const double x = c * velocity[n + j] + s * velocity[n + j + 1], y = c * velocity[n + j + 1] - s * velocity[n + j];
    const double slope = x * y / (x * x + rest * rest);
    const double cosine = 1 / std::sqrt(1 + slope * slope), sine = slope * cosine;
    current_[j] = c * cosine - s * sine;
    current_[j + 1] = s * cosine + c * sine;
  }
}

ContactRowData FrozenMode::rowsOf(const FrozenProblem &problem, const DenseMatrix &delassus, const std::vector<double> &friction) const {
  return {problem.normalCount, problem.tangentCount, &delassus, bias_.data(), problem.owner.data(), friction.data(), offset_.data()};
}

bool FrozenMode::isPosed() const { return posed_ && normal == posedNormal_ && tangent == posedTangent_ && sign == posedSign_; }

void FrozenMode::pose(const FrozenProblem &problem) {
  const int n = problem.normalCount, m = problem.tangentCount;
  posed_ = true;
  posedNormal_ = normal;
  posedTangent_ = tangent;
  posedSign_ = sign;
  friction_.assign(problem.friction.begin(), problem.friction.begin() + m);
  pairs_.clear();
  for (int i = 0; i < n; ++i) {
    active_[i] = normal[i] == Normal::Held;
    fixed_[i] = normal[i] == Normal::Push ? problem.rate[i] : 0.0;
  }
  for (int j = 0; j < m; ++j) {
    const bool isSlipping = tangent[j] == Tangent::Slip, isAlone = problem.partner[j] < 0;
    active_[n + j] = tangent[j] == Tangent::Stick;
    slip_[j] = static_cast<std::int8_t>(isSlipping && isAlone ? sign[j] : 0);
    if (isSlipping && problem.partner[j] > j)
      pairs_.push_back({j, problem.owner[j]});
  }
  const ContactRowData rows = rowsOf(problem, problem.delassus, friction_);
  unturned_.setMode(rows, active_.data(), slip_.data());
  unturned_.assemble(rows, factor_.regular.matrix());
  factor_.factor();
  const int active = unturned_.activeCount();
  own_.resize(active);
  unturned_.rightHandSide(rows, fixed_.data(), own_.data());
  factor_.solveNear(nearbyForces(unturned_), own_);
  response_.resize(active, 2 * static_cast<Eigen::Index>(pairs_.size()));
  Eigen::Index column = 0;
  for (SlippingPair &pair : pairs_) {
    pair.unknown = unturned_.position(pair.owner);
    for (const int row : {n + pair.row, n + pair.row + 1}) {
      unknown_.resize(active);
      for (int k = 0; k < active; ++k)
        unknown_[k] = problem.friction[pair.row] * problem.delassus(unturned_.active()[k], row);
      factor_.solve(unknown_);
      response_.col(column++) = unknown_;
    }
  }
}

// The normal forces of the pairs' owners, and with their friction all others. False: the pairs' own equations have no unique solution.
bool FrozenMode::solveByPairs() {
  constexpr double leastPivot = 1e-6;
  const auto count = static_cast<int>(pairs_.size());
  const auto responseOf = [this](int unknown, int pair) {
    const int row = pairs_[pair].row;
    return response_(unknown, 2 * pair) * current_[row] + response_(unknown, 2 * pair + 1) * current_[row + 1];
  };
  pairFactor_.matrix().resize(count, count);
  ownerForce_.resize(count);
  for (int a = 0; a < count; ++a) {
    const int unknown = pairs_[a].unknown;
    for (int b = 0; b < count; ++b)
      pairFactor_.matrix()(a, b) = (a == b ? 1.0 : 0.0) - (unknown >= 0 ? responseOf(unknown, b) : 0.0);
    ownerForce_[a] = unknown >= 0 ? own_[unknown] : fixed_[pairs_[a].owner];
  }
  if (count > 0 && !pairFactor_.factor(leastPivot))
    return false;
  if (count > 0)
    pairFactor_.solve(ownerForce_.data());
  unknown_ = own_;
  for (int b = 0; b < count; ++b) {
    const int row = pairs_[b].row;
    unknown_ += ownerForce_[b] * (current_[row] * response_.col(2 * b) + current_[row + 1] * response_.col(2 * b + 1));
  }
  redundant_ = factor_.isSingular;
  return true;
}

void FrozenMode::poseTurned(const FrozenProblem &problem) {
  const int n = problem.normalCount;
  turned_ = problem.delassus;
  turnedFriction_ = friction_;
  for (const SlippingPair &pair : pairs_) {
    turnRows(turned_, n + pair.row, current_[pair.row], current_[pair.row + 1]);
    turnedFriction_[pair.row + 1] = 0;
    slip_[pair.row] = static_cast<std::int8_t>(sign[pair.row]);
  }
  equations_.setMode(rowsOf(problem, turned_, turnedFriction_), active_.data(), slip_.data());
  for (const SlippingPair &pair : pairs_)
    slip_[pair.row] = 0;
}

// All equations at once.
void FrozenMode::solveTurned(const FrozenProblem &problem) {
  poseTurned(problem);
  const ContactRowData rows = rowsOf(problem, turned_, turnedFriction_);
  equations_.assemble(rows, turnedFactor_.regular.matrix());
  turnedFactor_.factor();
  redundant_ = turnedFactor_.isSingular;
  unknown_.resize(equations_.activeCount());
  equations_.rightHandSide(rows, fixed_.data(), unknown_.data());
  turnedFactor_.solveNear(nearbyForces(equations_), unknown_);
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    ownerForce_[k] = pairs_[k].unknown >= 0 ? unknown_[pairs_[k].unknown] : fixed_[pairs_[k].owner];
}

bool FrozenMode::forces(const FrozenProblem &problem, const std::vector<double> &velocity, double rest, std::vector<double> &force) {
  const int n = problem.normalCount;
  turnDirections(problem, velocity, rest);
  if (!isPosed())
    pose(problem);
  if (!solveByPairs())
    solveTurned(problem);
  force.resize(n + problem.tangentCount);
  unturned_.expandForces(rowsOf(problem, problem.delassus, friction_), unknown_.data(), force.data());
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const int row = pairs_[k].row;
    const double along = -problem.friction[row] * ownerForce_[k];
    force[n + row] = current_[row] * along;
    force[n + row + 1] = current_[row + 1] * along;
  }
  return std::all_of(force.begin(), force.end(), [](double f) { return std::isfinite(f); });
}

// Of the forces that are unknowns of the equations; their number.
int FrozenMode::poseLimits(const FrozenProblem &problem) {
  const int n = problem.normalCount;
  std::vector<ConicForces::Limit> limits;
  limits.reserve(equations_.active().size() * 2);
  for (const int row : equations_.active()) {
    const int own = equations_.position(row);
    if (row < n) {
      limits.push_back({own, 1, 0, -1, -1});
      limits.push_back({own, -1, problem.rate[row], -1, -1});
      continue;
    }
    const int j = row - n, partner = problem.partner[j], owner = problem.owner[j], apex = equations_.position(owner);
    if (partner >= 0 && partner < j)
      continue;
    const double offset = apex < 0 ? problem.friction[j] * fixed_[owner] : 0.0;
    limits.push_back({apex, apex < 0 ? 0.0 : problem.friction[j], offset, own, partner < 0 ? -1 : own + 1});
  }
  admissible_.forget();
  admissible_.resize(equations_.activeCount(), static_cast<int>(limits.size()));
  for (std::size_t k = 0; k < limits.size(); ++k)
    admissible_.limit(static_cast<int>(k)) = limits[k];
  return static_cast<int>(limits.size());
}

bool FrozenMode::center(const FrozenProblem &problem, std::vector<int> &leaving) {
  constexpr double consistent = 1e-6;
  poseTurned(problem);
  const ContactRowData rows = rowsOf(problem, turned_, turnedFriction_);
  const int limitCount = poseLimits(problem);
  DenseMatrix matrix;
  equations_.assemble(rows, matrix);
  admissible_.matrix() = matrix.map();
  equations_.rightHandSide(rows, fixed_.data(), admissible_.rhs().data());
  leaving.assign(problem.count(), 0);
  if (!admissible_.prepare(consistent))
    return false;
  const double none = leastMargin * admissible_.scale();
  if (!(admissible_.largestSlack() > none)) {
    for (int k = 0; k < limitCount; ++k)
      if (const ConicForces::Limit &limit = admissible_.limit(k); admissible_.slack(k, admissible_.innermost()) <= none)
        leaving[equations_.active()[limit.first < 0 ? limit.apex : limit.first]] = limit.first < 0 && limit.factor > 0 ? -1 : 1;
    return false;
  }
  for (int k = 0; k < equations_.activeCount(); ++k)
    nearby_[equations_.active()[k]] = admissible_.innermost()[k];
  posed_ = false;
  return true;
}

}  // namespace tf::runtime
