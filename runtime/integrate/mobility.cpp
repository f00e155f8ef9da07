#include "runtime/integrate/mobility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace tf::runtime {

namespace {

// A row whose part that is independent of the others is below this share of its length counts as redundant. Rows that depend on each other
// differ by the drift of the positions, which projection holds at round-off.
constexpr double independence = 1e-6;
// A row that is shorter than this part of what it is elsewhere is compared with that instead of with itself.
constexpr double nearlyVanishing = 1e-3;

}  // namespace

Mobility::Mobility(MassMatrix mass, int constraints)
    : nv_(mass.size()), nh_(constraints), rank_(constraints), mass_(std::move(mass)), jacobian_(nv_, constraints),
      response_(nv_, constraints), half_(nv_, constraints), scaledHalf_(nv_, constraints), inertia_(constraints, constraints),
      scale_(constraints), shares_(constraints), factor_(constraints), decomposition_(constraints, constraints), work_(constraints),
      solution_(constraints), second_(nv_) {
  decomposition_.setThreshold(independence * independence);
}

bool Mobility::setMass(const double *mass) { return mass_.factorise(mass); }

bool Mobility::setConstraints(const double *jacobian, const double *shares) {
  for (int k = 0; k < nh_; ++k) {
    const Eigen::Map<const Eigen::VectorXd> row(jacobian + static_cast<std::ptrdiff_t>(k) * nv_, nv_);
    if (!row.allFinite())
      return false;
    mass_.forward(row.data(), half_.col(k).data(), scaledHalf_.col(k).data());
    response_.col(k).setZero();
    second_ = scaledHalf_.col(k);
    mass_.addBackward(second_.data(), response_.col(k).data());
    const double length = std::sqrt(row.dot(response_.col(k)));
    // A row that vanishes, as at a singular position, has no force.
    shares_[k] = std::min(1.0, shares[k]);
    const double reduced = std::min(1.0, shares[k] / nearlyVanishing);
    scale_[k] = length > 0 && reduced > independence ? reduced / length : 0;
    jacobian_.col(k) = scale_[k] * row;
    response_.col(k) *= scale_[k];
    half_.col(k) *= scale_[k];
    scaledHalf_.col(k) *= scale_[k];
  }
  factorise();
  return true;
}

void Mobility::factorise() {
  inertia_.noalias() = jacobian_.transpose() * response_;
  isReduced_ = !kept_.empty();
  rank_ = isReduced_ ? static_cast<int>(kept_.size()) : nh_;
  if (isReduced_)
    factor_.compute(inertia_(kept_, kept_));
  else
    factor_.compute(inertia_);
  // The pivots of the Cholesky factor are the independent parts of the rows, in their order.
  bool isRegular = factor_.info() == Eigen::Success;
  for (int k = 0; k < rank_ && isRegular; ++k)
    isRegular = factor_.matrixLLT()(k, k) > independence;
  if (isRegular)
    return;
  isReduced_ = false;
  decomposition_.compute(inertia_);
  rank_ = static_cast<int>(decomposition_.rank());
}

Mobility::Pivots Mobility::pivots() const {
  Pivots found;
  Eigen::MatrixXd rest = inertia_;
  while (static_cast<int>(found.rows.size()) < nh_) {
    int largest = -1;
    double part = 0;
    for (int k = 0; k < nh_; ++k) {
      if (!(rest(k, k) > independence * independence))
        continue;
      if (const double own = independentLength(k, std::sqrt(rest(k, k))); own > part) {
        largest = k;
        part = own;
      }
    }
    if (largest < 0)
      break;
    found.rows.push_back(largest);
    found.least = part;
    const Eigen::VectorXd column = rest.col(largest) / std::sqrt(rest(largest, largest));
    rest.noalias() -= column * column.transpose();
    rest(largest, largest) = 0;
  }
  std::sort(found.rows.begin(), found.rows.end());
  return found;
}

// A pivot of the row, as a part of the row's length elsewhere.
double Mobility::independentLength(int row, double pivot) const { return pivot * std::max(shares_[row], nearlyVanishing); }

std::optional<Mobility::WeakRow> Mobility::weakestRow() const {
  if (rank_ < nh_ && !isReduced_)
    return std::nullopt;
  WeakRow weakest{-1, std::numeric_limits<double>::infinity()};
  for (int j = 0; j < rank_; ++j) {
    const int row = isReduced_ ? kept_[static_cast<std::size_t>(j)] : j;
    if (const double part = independentLength(row, factor_.matrixLLT()(j, j)); part < weakest.part)
      weakest = {row, part};
  }
  return weakest;
}

bool Mobility::chooseIndependent(bool isElsewhere) {
  constexpr double clearlyLess = 0.3;
  if ((rank_ == nh_ && deficiency_ == 0) || (!isElsewhere && kept_.empty()))
    return false;
  Pivots best = pivots();
  const int now = nh_ - static_cast<int>(best.rows.size()), before = isElsewhere ? std::exchange(deficiency_, now) : deficiency_;
  // More of them here than before depend on each other, perhaps here only.
  if (before > 0 && now > before)
    return false;
  deficiency_ = now;
  if (before == 0 || now == 0)
    best.rows.clear();
  // Rows that are about as independent stay.
  if (best.rows == kept_ || (isReduced_ && best.rows.size() == kept_.size() && weakestRow()->part > clearlyLess * best.least))
    return false;
  kept_ = std::move(best.rows);
  factorise();
  return true;
}

void Mobility::keepAll() {
  deficiency_ = 0;
  if (kept_.empty())
    return;
  kept_.clear();
  factorise();
}

// Cholesky's method in the order of the rows: the pivots of dependent ones vanish. Their coefficients are those of the projection onto the
// independent rows before them, in the metric of M⁻¹.
std::vector<DependentRow> Mobility::dependentRows() const {
  std::vector<DependentRow> dependent;
  std::vector<int> independent;
  Eigen::MatrixXd rest = inertia_;
  for (int k = 0; k < nh_; ++k) {
    if (rest(k, k) > independence * independence) {
      const Eigen::VectorXd column = rest.col(k) / std::sqrt(rest(k, k));
      rest.noalias() -= column * column.transpose();
      independent.push_back(k);
      continue;
    }
    DependentRow row{k, {}};
    const Eigen::MatrixXd basis = inertia_(independent, independent);
    const Eigen::VectorXd shares = basis.ldlt().solve(inertia_(independent, std::array{k}));
    for (std::size_t j = 0; j < independent.size(); ++j)
      if (std::abs(shares[static_cast<Eigen::Index>(j)]) > independence * shares.lpNorm<Eigen::Infinity>())
        row.sources.push_back(independent[j]);
    dependent.push_back(std::move(row));
  }
  return dependent;
}

void Mobility::solve(Eigen::VectorXd &residual) const {
  if (!isReduced_) {
    solveAll(residual);
    return;
  }
  keptWork_ = residual(kept_);
  factor_.solveInPlace(keptWork_);
  residual.setZero();
  residual(kept_) = keptWork_;
}

void Mobility::solveAll(Eigen::VectorXd &residual) const {
  if (rank_ == nh_) {
    factor_.solveInPlace(residual);
    return;
  }
  if (isReduced_)
    decomposition_.compute(inertia_);
  solution_ = decomposition_.solve(residual);
  residual = solution_;
}

// x += M⁻¹ Hᵀ ν for ν in work_.
void Mobility::react(double *x) const { Eigen::Map<Eigen::VectorXd>(x, nv_).noalias() += response_ * work_; }

void Mobility::constrain(const double *b, double *z, double *scaled) const {
  work_.noalias() = response_.transpose() * Eigen::Map<const Eigen::VectorXd>(b, nv_);
  solve(work_);
  Eigen::Map<Eigen::VectorXd>(z, nv_).noalias() -= half_ * work_;
  Eigen::Map<Eigen::VectorXd>(scaled, nv_).noalias() -= scaledHalf_ * work_;
}

void Mobility::apply(const double *b, double *x) const { accelerate(b, nullptr, x); }

void Mobility::accelerate(const double *force, const double *bias, double *acceleration) const {
  mass_.solve(force, acceleration);
  if (nh_ == 0)
    return;
  work_.noalias() = -jacobian_.transpose() * Eigen::Map<const Eigen::VectorXd>(acceleration, nv_);
  for (int k = 0; bias != nullptr && k < nh_; ++k)
    work_[k] -= scale_[k] * bias[k];
  solve(work_);
  react(acceleration);
}

void Mobility::multipliers(const double *force, const double *bias, double *multipliers) const {
  work_.noalias() = -response_.transpose() * Eigen::Map<const Eigen::VectorXd>(force, nv_);
  for (int k = 0; bias != nullptr && k < nh_; ++k)
    work_[k] -= scale_[k] * bias[k];
  solveAll(work_);
  for (int k = 0; k < nh_; ++k)
    multipliers[k] = scale_[k] * work_[k];
}

void Mobility::correct(const double *residual, double *x) const {
  for (int k = 0; k < nh_; ++k)
    work_[k] = scale_[k] * residual[k];
  solve(work_);
  react(x);
}

}  // namespace tf::runtime
