#include "runtime/contact/frozen_mode.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Pivots below, relative to the largest entry of D, are those of redundant rows.
constexpr double singular = 1e-11;
// Margins to limits below, relative to the rates, are none.
constexpr double leastMargin = 1e-9;

void turnRows(DenseMatrix &matrix, int a, double c, double s) {
  const int count = matrix.rows();
  const auto turn = [c, s](double &x, double &y) {
    const double along = c * x + s * y;
    y = c * y - s * x;
    x = along;
  };
  for (int r = 0; r < count; ++r)
    turn(matrix(r, a), matrix(r, a + 1));
  for (int r = 0; r < count; ++r)
    turn(matrix(a, r), matrix(a + 1, r));
}

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
  friction_.assign(m, 0.0);
  offset_.assign(m, 0.0);
  bias_.assign(n + m, 0.0);
  acceleration_.assign(n + m, 0.0);
  fixed_.assign(n, 0.0);
  reference_.assign(n + m, 0.0);
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

void FrozenMode::turnBack(const FrozenProblem &problem, std::vector<double> &forces) const {
  for (int j = 0; j < problem.tangentCount; ++j) {
    if (problem.partner[j] < j)
      continue;
    double &first = forces[problem.normalCount + j], &second = forces[problem.normalCount + j + 1];
    const double x = direction[j] * first - direction[j + 1] * second;
    second = direction[j + 1] * first + direction[j] * second;
    first = x;
  }
}

void FrozenMode::align(const FrozenProblem &problem, const std::vector<double> &velocity, double rest) {
  const int n = problem.normalCount;
  turned_ = problem.delassus;
  for (int j = 0; j < problem.tangentCount; ++j) {
    friction_[j] = problem.friction[j];
    if (problem.partner[j] < j || tangent[j] != Tangent::Slip)
      continue;
    const double c = direction[j], s = direction[j + 1];
    const double x = c * velocity[n + j] + s * velocity[n + j + 1], y = c * velocity[n + j + 1] - s * velocity[n + j];
    const double slope = x * y / (x * x + rest * rest);
    const double cosine = 1 / std::sqrt(1 + slope * slope), sine = slope * cosine;
    current_[j] = c * cosine - s * sine;
    current_[j + 1] = s * cosine + c * sine;
    turnRows(turned_, n + j, current_[j], current_[j + 1]);
    friction_[++j] = 0;
  }
}

bool FrozenMode::forces(const FrozenProblem &problem, const std::vector<double> &velocity, double rest, std::vector<double> &force) {
  const int n = problem.normalCount, m = problem.tangentCount;
  align(problem, velocity, rest);
  for (int i = 0; i < n; ++i) {
    active_[i] = normal[i] == Normal::Held;
    fixed_[i] = normal[i] == Normal::Push ? problem.rate[i] : 0.0;
  }
  for (int j = 0; j < m; ++j) {
    active_[n + j] = tangent[j] == Tangent::Stick;
    slip_[j] = static_cast<std::int8_t>(tangent[j] == Tangent::Slip ? sign[j] : 0);
  }
  const ContactRowData rows = {n, m, &turned_, bias_.data(), problem.owner.data(), friction_.data(), offset_.data()};
  equations_.setMode(rows, active_.data(), slip_.data());
  equations_.assemble(rows, factor_.matrix());
  const int active = equations_.activeCount();
  unknown_.resize(active);
  equations_.rightHandSide(rows, fixed_.data(), unknown_.data());
  double largest = 0;
  for (int k = 0; k < active; ++k)
    largest = std::max(largest, factor_.matrix()(k, k));
  const Eigen::MatrixXd matrix = factor_.matrix().map();
  redundant_ = active > 0 && !factor_.factor(singular * largest);
  if (redundant_) {
    Eigen::VectorXd reference(active);
    for (int k = 0; k < active; ++k)
      reference[k] = reference_[equations_.active()[k]];
    Eigen::Map<Eigen::VectorXd> unknown(unknown_.data(), active);
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
    decomposition.setThreshold(singular);
    decomposition.compute(matrix);
    unknown = reference + decomposition.solve(unknown - matrix * reference).eval();
  } else if (active > 0) {
    factor_.solve(unknown_.data());
  }
  force.resize(n + m);
  equations_.expand(rows, unknown_.data(), force.data(), acceleration_.data());
  for (int j = 0; j < m; ++j) {
    if (problem.partner[j] < j || tangent[j] != Tangent::Slip)
      continue;
    const double along = force[n + j];
    force[n + j] = current_[j] * along;
    force[n + j + 1] = current_[j + 1] * along;
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
  admissible_.resize(equations_.activeCount(), static_cast<int>(limits.size()));
  for (std::size_t k = 0; k < limits.size(); ++k)
    admissible_.limit(static_cast<int>(k)) = limits[k];
  return static_cast<int>(limits.size());
}

bool FrozenMode::center(const FrozenProblem &problem, std::vector<int> &leaving) {
  constexpr double consistent = 1e-6;
  const ContactRowData rows = {problem.normalCount,  problem.tangentCount, &turned_,      bias_.data(),
                               problem.owner.data(), friction_.data(),     offset_.data()};
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
    reference_[equations_.active()[k]] = admissible_.innermost()[k];
  return true;
}

}  // namespace tf::runtime
