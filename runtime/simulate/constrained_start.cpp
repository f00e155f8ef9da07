#include "runtime/simulate/constrained_start.h"
#include "runtime/simulate/source_texts.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

constexpr double accepted = 1e-9;

// For each velocity, the first coordinate that it moves: a rotation's three velocities move the four of its quaternion.
std::vector<int> coordinatesOfVelocities(const tf_model &model) {
  std::vector<int> coordinates;
  for (int i = 0; i < model.nq; ++i) {
    const bool isRotation = std::find(model.quaternions, model.quaternions + model.nr, i) != model.quaternions + model.nr;
    coordinates.insert(coordinates.end(), isRotation ? 3 : 1, i);
    i += isRotation ? 3 : 0;
  }
  return coordinates;
}

}  // namespace

ConstrainedStart::ConstrainedStart(ModelEvaluation &evaluation) : at_(evaluation), change_(evaluation.model().nv) {
  const tf_model &model = at_.model();
  const std::vector<int> coordinates = coordinatesOfVelocities(model);
  for (int k = 0; k < model.variable_count; ++k) {
    const tf_variable &variable = model.variables[k];
    if ((variable.flags & TF_FIXED) != 0)
      continue;
    if (variable.kind == TF_KIND_VELOCITY)
      freeVelocities_.push_back(variable.index);
    for (int v = 0; variable.kind == TF_KIND_COORDINATE && v < model.nv; ++v)
      if (coordinates[static_cast<std::size_t>(v)] == variable.index)
        freeCoordinates_.push_back(v);
  }
}

void ConstrainedStart::leastChange(const std::vector<double> &residual, const std::vector<int> &free, bool holonomicOnly) {
  const tf_model &model = at_.model();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(model.nh, static_cast<Eigen::Index>(free.size()));
  Eigen::VectorXd wanted = Eigen::VectorXd::Zero(model.nh);
  for (int k = 0; k < model.nk; ++k) {
    const tf_constraint &constraint = model.constraints[k];
    if (holonomicOnly && constraint.holonomic == 0)
      continue;
    for (int row = constraint.row_first; row < constraint.row_first + constraint.row_count; ++row) {
      wanted[row] = -residual[row];
      for (std::size_t j = 0; j < free.size(); ++j)
        rows(row, static_cast<Eigen::Index>(j)) = at_.constraintJacobian[row * model.nv + free[j]];
    }
  }
  const Eigen::VectorXd step = rows.completeOrthogonalDecomposition().solve(wanted);
  std::fill(change_.begin(), change_.end(), 0.0);
  for (std::size_t j = 0; j < free.size(); ++j)
    change_[free[j]] = step[static_cast<Eigen::Index>(j)];
}

void ConstrainedStart::solveCoordinates(double *state) {
  constexpr int mostIterations = 150, cautious = 100;
  double previous = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < mostIterations; ++iteration) {
    at_.constraintResiduals();
    at_.constraintRows();
    leastChange(at_.residual, freeCoordinates_, true);
    double size = 0;
    for (const double change : change_)
      size = std::max(size, std::abs(change));
    if (size == 0 || !std::isfinite(size) || (size < 1e-12 && size >= previous))
      return;
    previous = size;
    // Far from the constraints full steps may go astray: at most a radian, or a unit, at a time. Those that are still on their way after
    // many have far to go.
    if (const double most = std::ldexp(1.0, std::max(0, iteration - cautious)); size > most)
      for (double &change : change_)
        change *= most / size;
    at_.moveCoordinates(state, change_.data());
  }
}

void ConstrainedStart::solveVelocities(double *state) {
  const tf_model &model = at_.model();
  at_.constraintResiduals();
  at_.constraintRows();
  leastChange(at_.residualRate, freeVelocities_, false);
  for (int i = 0; i < model.nv; ++i)
    if (std::isfinite(change_[i]))
      state[model.nq + i] += change_[i];
}

// The violated rows, as far as free coordinates or velocities move them, depend on each other: no start satisfies all of them.
bool ConstrainedStart::contradict(const std::vector<int> &rows, const std::vector<int> &free) const {
  if (rows.size() < 2 || free.empty())
    return false;
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(free.size()));
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t j = 0; j < free.size(); ++j)
      moved(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = at_.constraintJacobian[rows[i] * at_.model().nv + free[j]];
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(moved);
  factor.setThreshold(1e-6);
  return factor.rank() > 0 && factor.rank() < static_cast<Eigen::Index>(rows.size());
}

std::string ConstrainedStart::violation(bool ofVelocities) const {
  const tf_model &model = at_.model();
  std::string text;
  std::vector<int> rows;
  for (int k = 0; k < model.nk; ++k) {
    const tf_constraint &constraint = model.constraints[k];
    double worst = 0;
    bool isViolated = false;
    for (int row = constraint.row_first; row < constraint.row_first + constraint.row_count; ++row) {
      const double value = ofVelocities ? at_.residualRate[row] : constraint.holonomic != 0 ? at_.residual[row] : 0;
      const double scale = ofVelocities ? at_.scales.residualRate(row, at_.velocities()) : at_.scales.residual(row);
      worst = std::isfinite(value) ? std::max(worst, std::abs(value)) : std::numeric_limits<double>::infinity();
      if (std::abs(value) <= accepted * scale)
        continue;
      rows.push_back(row);
      isViolated = true;
    }
    if (!isViolated)
      continue;
    text += fmt::format("{}the start {} constraint '{}' by {:.6g} {}", text.empty() ? "" : "; ",
                        ofVelocities ? "of the velocities violates" : "violates", constraint.name, worst, sourceOf(constraint.location));
  }
  if (contradict(rows, ofVelocities ? freeVelocities_ : freeCoordinates_))
    return text + (ofVelocities ? "; they contradict each other, whatever the free velocities are"
                                : "; they contradict each other near the start, whatever the free coordinates are");
  return text.empty() ? text : text + (ofVelocities ? "; der(fixed = false) frees a velocity" : "; fixed = false frees a coordinate");
}

std::string ConstrainedStart::solve(double time, double *state) {
  if (at_.model().nh == 0)
    return {};
  at_.setPoint(time, state);
  if (!freeCoordinates_.empty()) {
    solveCoordinates(state);
    // What residuals are compared with may be another magnitude there.
    at_.measureScales(time, state);
    at_.setPoint(time, state);
  }
  at_.constraintResiduals();
  if (std::string text = violation(false); !text.empty())
    return text;
  if (!freeVelocities_.empty())
    solveVelocities(state);
  at_.constraintResiduals();
  return violation(true);
}

}  // namespace tf::runtime
