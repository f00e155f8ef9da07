// Rates of change of the forces, and multipliers of their shares, from the equations of the mode that has been solved.
#include "runtime/contact/dense_kernels.h"
#include "runtime/contact/force_set.h"

#include <cassert>

namespace tf::runtime {

// A ẋ = −(accelerationRate + D ḃ) with ḃ = −s limitRate on the slipping rows: the same equations with other data.
void ForceSet::forceRates(const ContactProblem &problem, const double *accelerationRate, const double *limitRate, double *forceRate) {
  view(problem);
  ContactRowData rates = rows_;
  rates.bias = accelerationRate;
  rates.offset = limitRate;
  equations_.rightHandSide(rates, fixed_.data(), unknown_.data());
  factor_.solve(unknown_.data());
  equations_.expandForces(rates, unknown_.data(), forceRate);
}

// The same with the active limits kept: slack 0 = friction x_n + offset − side x_t has the derivative 0 too. With weights w the least-norm
// forces have w² x = Aᵀ z + Σ m ∇slack; dx follows in w dx from A dx and, of its part in the null space, from that equation's derivative.
void ForceSet::leastNormRates(const ContactProblem &problem, const double *accelerationRate, const double *limitRate,
                              const ShareRates *shares, double *forceRate) {
  view(problem);
  [[maybe_unused]] const bool hasAll = solveAll();
  assert(hasAll);
  ContactRowData rates = rows_;
  rates.bias = accelerationRate;
  rates.offset = limitRate;
  equations_.rightHandSide(rates, fixed_.data(), unknown_.data());
  gradientRate_.setZero(activeCount());
  if (shares != nullptr)
    shareGradient(*shares);
  if (conic_)
    conicPointRate();
  else
    pointRate(limitRate);
  for (int c = 0; c < activeCount(); ++c)
    unknown_[c] = pointRate_[c] / weight_[c];
  equations_.expandForces(rates, unknown_.data(), forceRate);
}

// Out of A dx in unknown_ and gradientRate_.
void ForceSet::pointRate(const double *limitRate) {
  const int k = activeCount(), n = rows_.normalCount;
  boundRate_.resize(length_.size());
  for (int r = 0; r < k; ++r)
    boundRate_[r] = unknown_[r] / length_[r];
  for (std::size_t l = 0; l < limits_.size(); ++l)
    boundRate_[k + l] = limits_[l].side == 0 ? 0.0 : -limitRate[limits_[l].row - n] / length_[k + l];
  for (const int constraint : polyhedron_.active())
    boundRate_[constraint] -= denseDot(polyhedron_.normal(constraint), gradientRate_.data(), k);
  pointRate_.resize(k);
  polyhedron_.pointOf(boundRate_.data(), pointRate_.data());
  pointRate_ += gradientRate_;
}

// As well, of the equations alone.
void ForceSet::conicPointRate() {
  const int k = activeCount();
  rhsRate_.resize(k);
  for (int r = 0; r < k; ++r)
    rhsRate_[r] = unknown_[r] / length_[r];
  cone_.subtractProduct(gradientRate_, rhsRate_);
  cone_.solve(rhsRate_, pointRate_);
  pointRate_ += gradientRate_;
}

// Of Aᵀ z + Σ m ∇slack − w² x at fixed z, m and x, over w. Aᵀ z = Eᵀ D z.
void ForceSet::shareGradient(const ShareRates &shares) {
  const int k = activeCount(), n = rows_.normalCount;
  for (int c = 0; c < k; ++c)
    gradientRate_[c] = shares.multiplierAcceleration[equations_.active()[c]];
  ContactRowData changes = rows_;
  changes.friction = shares.friction;
  for (int j = 0; j < rows_.tangentCount; ++j) {
    const int owner = rows_.owner[j], position = owner >= 0 ? equations_.position(owner) : -1;
    const double factor = equations_.slipFactor(rows_, j), change = equations_.slipFactor(changes, j);
    if (position >= 0)
      gradientRate_[position] +=
          factor * shares.multiplierAcceleration[n + j] + change * multiplierAcceleration_[n + j] - 2 * factor * change * forces_[owner];
  }
  for (std::size_t l = 0; l < limits_.size(); ++l)
    if (const int j = limits_[l].row - n; j >= 0 && rows_.owner[j] >= 0)
      gradientRate_[equations_.position(rows_.owner[j])] += limitMultiplier_[l] * shares.friction[j];
  for (int c = 0; c < k; ++c)
    gradientRate_[c] /= weight_[c];
}

const std::vector<double> &ForceSet::shareMultipliers(const ContactProblem &problem) {
  view(problem);
  [[maybe_unused]] const bool hasAll = solveAll();
  assert(hasAll);
  const int count = rows_.normalCount + rows_.tangentCount;
  Eigen::VectorXd equations;
  limitMultiplier_.assign(limits_.size(), 0.0);
  if (conic_)
    cone_.multipliersOf(cone_.freePoint(), equations);
  else
    findPolyhedronMultipliers(equations);
  multiplier_.assign(count, 0.0);
  for (int r = 0; r < activeCount(); ++r)
    multiplier_[equations_.active()[r]] = equations[r] / length_[r];
  multiplierAcceleration_.resize(count);
  for (int row = 0; row < count; ++row)
    multiplierAcceleration_[row] = denseDot(rows_.delassus->column(row), multiplier_.data(), count);
  return multiplier_;
}

// Of equations and limits of unit length; those of the limits into limitMultiplier_, of the limits themselves.
void ForceSet::findPolyhedronMultipliers(Eigen::VectorXd &equations) {
  const int k = activeCount();
  equations.setZero(k);
  for (std::size_t a = 0; a < polyhedron_.active().size(); ++a)
    if (const int constraint = polyhedron_.active()[a]; constraint < k)
      equations[constraint] = polyhedron_.multipliers()[a];
    else
      limitMultiplier_[constraint - k] = polyhedron_.multipliers()[a] / length_[constraint];
}

}  // namespace tf::runtime
