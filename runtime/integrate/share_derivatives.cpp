#include "runtime/integrate/share_derivatives.h"

#include <algorithm>

namespace tf::runtime {

namespace {

void add(const std::vector<double> &change, std::vector<double> &values) {
  std::transform(values.begin(), values.end(), change.begin(), values.begin(), std::plus<>());
}

// `changed` becomes what it was before, and `difference` by how much it has changed.
void takeDifference(std::vector<double> &difference, std::vector<double> &changed) {
  std::swap(difference, changed);
  std::transform(difference.begin(), difference.end(), changed.begin(), difference.begin(), std::minus<>());
}

}  // namespace

void ShareDerivatives::evaluate(ModelEvaluation &at, const RowSystem &rows, const std::uint8_t *mask, std::span<const double> multipliers) {
  const tf_model &model = at.model();
  force_.assign(static_cast<std::size_t>(model.nv), 0.0);
  acceleration_.resize(force_.size());
  constraintForce_.assign(static_cast<std::size_t>(model.nh), 0.0);
  rows.addForces(multipliers.data(), force_.data());
  at.mobility.accelerate(force_.data(), nullptr, acceleration_.data());
  if (model.nh > 0)
    at.mobility.multipliers(force_.data(), nullptr, constraintForce_.data());
  residualByState_ = at.residualByState;
  normalByState_ = at.normalByState;
  tangentByState_ = at.tangentByState;
  constraintByState_ = at.constraintByState;
  const std::vector<double> acceleration = at.acceleration, normalForce = at.normalForce, tangentForce = at.tangentForce,
                            multiplier = at.multiplier;
  std::fill(at.normalForce.begin(), at.normalForce.end(), 0.0);
  std::fill(at.tangentForce.begin(), at.tangentForce.end(), 0.0);
  for (int i = 0; i < rows.normalCount(); ++i)
    at.normalForce[static_cast<std::size_t>(rows.contacts()[static_cast<std::size_t>(i)])] = multipliers[static_cast<std::size_t>(i)];
  rows.spreadTangentForces(multipliers.data() + rows.normalCount(), at.tangentForce.data());
  add(normalForce, at.normalForce);
  add(tangentForce, at.tangentForce);
  add(acceleration_, at.acceleration);
  add(constraintForce_, at.multiplier);
  at.dynamicsDerivatives(mask);
  at.acceleration = acceleration;
  at.normalForce = normalForce;
  at.tangentForce = tangentForce;
  at.multiplier = multiplier;
  takeDifference(residualByState_, at.residualByState);
  takeDifference(normalByState_, at.normalByState);
  takeDifference(tangentByState_, at.tangentByState);
  takeDifference(constraintByState_, at.constraintByState);
}

// W (dJᵀ z − dM u) under the constraints, by the rows, and what they themselves change by.
void ShareDerivatives::column(const ModelEvaluation &at, const RowSystem &rows, int column, std::span<double> rate) {
  const int nx = at.columns(), normals = rows.normalCount();
  forceChange_.resize(force_.size());
  constraintChange_.resize(constraintForce_.size());
  for (std::size_t i = 0; i < forceChange_.size(); ++i)
    forceChange_[i] = -residualByState_[i * nx + column];
  for (std::size_t i = 0; i < constraintChange_.size(); ++i)
    constraintChange_[i] = constraintByState_[i * nx + column];
  at.mobility.accelerate(forceChange_.data(), constraintChange_.data(), forceChange_.data());
  for (int i = 0; i < rows.count(); ++i)
    rate[static_cast<std::size_t>(i)] =
        rows.product(i, forceChange_.data()) + (i < normals ? normalByState_[static_cast<std::size_t>(rows.contacts()[i]) * nx + column]
                                                            : rows.tangentValue(tangentByState_.data() + column, nx, i - normals));
}

}  // namespace tf::runtime
