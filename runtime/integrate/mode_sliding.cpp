// Sliding modes of switches: the step variables with which a motion stays on the surfaces of its conditions.
#include "runtime/integrate/mode_dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

void ModeDynamics::conditionRates(double *rates) {
  const tf_model &model = at_.model();
  const int nx = at_.columns();
  std::vector<double> &qDot = shifted_;
  at_.kinematics(qDot.data());
  for (std::size_t s = 0; s < sliding_.size(); ++s) {
    const double *row = at_.conditionGradient.data() + static_cast<std::ptrdiff_t>(sliding_[s]) * nx;
    double sum = 0;
    for (int i = 0; i < model.nq; ++i)
      sum += *row++ * qDot[i];
    for (int i = 0; i < model.nv; ++i)
      sum += *row++ * at_.acceleration[i];
    for (int i = 0; i < model.nz; ++i)
      sum += *row++ * at_.stateRate[i];
    for (int i = 0; i < model.nu; ++i)
      sum += *row++ * at_.inputRate[i];
    rates[s] = sum + *row;
  }
}

// Coefficients and bounds of friction may have switches, in which they are affine: by how much they change from side to side of switch j.
void ModeDynamics::findLimitSteps(int j, Eigen::Ref<Eigen::VectorXd> steps) {
  const auto limit = [this](Eigen::Index row) { return problem_.owner[row] >= 0 ? problem_.friction[row] : problem_.bound[row]; };
  double &step = at_.stepVariable[j];
  const double here = step;
  steps.setZero();
  for (const double side : {0.0, 1.0}) {
    step = side;
    readLimits();
    for (Eigen::Index row = 0; row < steps.size(); ++row)
      steps[row] += (side == 0 ? -1 : 1) * limit(row);
  }
  step = here;
  readLimits();
}

Eigen::Index ModeDynamics::limitStepCount() const { return limitsVary_ ? static_cast<Eigen::Index>(rows_.tangents().size()) : 0; }

void ModeDynamics::readLimits() {
  at_.contactTerms(mask_.data());
  rows_.gatherLimits(at_, problem_);
}

// d c_s/dt changes by this per step variable j, with which limits change by `limitSteps` (none: they do not). The gradient of c_s and
// stepDerivatives have been evaluated.
double ModeDynamics::slopeByStep(int s, int j, const Eigen::Ref<const Eigen::VectorXd> &limitSteps) {
  const tf_model &model = at_.model();
  std::vector<double> &column = minus_;
  for (int i = 0; i < model.nv; ++i)
    column[i] = at_.forceByStep[i * model.ns + j];
  std::vector<double> limitChange(static_cast<std::size_t>(limitSteps.size()));
  for (std::size_t row = 0; row < limitChange.size(); ++row)
    limitChange[row] = limitSteps[static_cast<Eigen::Index>(row)] * (problem_.owner[row] >= 0 ? rowForces()[problem_.owner[row]] : 1);
  response(column.data(), nullptr, nullptr, limitChange.empty() ? nullptr : limitChange.data(), change_.data());
  const double *gradient = at_.conditionGradient.data() + static_cast<std::ptrdiff_t>(s) * at_.columns() + model.nq;
  double sum = 0;
  for (int i = 0; i < model.nv; ++i)
    sum += gradient[i] * change_[i];
  for (int i = 0; i < model.nz; ++i)
    sum += gradient[model.nv + i] * at_.stateRateByStep[i * model.ns + j];
  return sum;
}

double ModeDynamics::slopeJump(int j) {
  complete();
  Eigen::VectorXd limitSteps(limitStepCount());
  if (limitSteps.size() > 0)
    findLimitSteps(j, limitSteps);
  at_.stepDerivatives();
  return std::abs(slopeByStep(j, j, limitSteps));
}

// Newton's method for d c_j/dt (alpha) = 0; one iteration where f is affine in the sliding step variables.
bool ModeDynamics::solveSliding() {
  const int count = static_cast<int>(sliding_.size());
  at_.switchGradients(slidingMask_.data());
  limitSteps_.resize(limitStepCount(), count);
  for (int k = 0; k < count && limitSteps_.rows() > 0; ++k)
    findLimitSteps(sliding_[k], limitSteps_.col(k));
  const bool limitsFollow = (limitSteps_.array() != 0).any();
  double previous = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 30; ++iteration) {
    conditionRates(slidingResidual_.data());
    at_.stepDerivatives();
    for (int k = 0; k < count; ++k)
      for (int s = 0; s < count; ++s)
        slidingMatrix_(s, k) = slopeByStep(sliding_[s], sliding_[k], limitSteps_.col(k));
    slidingFactor_.compute(slidingMatrix_);
    const Eigen::Map<Eigen::VectorXd> residual(slidingResidual_.data(), count);
    const Eigen::VectorXd step = slidingFactor_.solve(residual);
    if (!step.allFinite())
      return fail(EvaluationFailure::SlidingDiverged);
    for (int k = 0; k < count; ++k)
      at_.stepVariable[sliding_[k]] -= step[k];
    at_.forces();
    if (limitsFollow)
      readLimits();
    if (!solveForces())
      return false;
    const double size = step.lpNorm<Eigen::Infinity>();
    if (size <= 1e-15 || (size >= previous && size <= 1e-12))
      return true;
    if (count == 1 && iteration == 1 && size <= 1e-13)
      return true;
    previous = size;
  }
  return fail(EvaluationFailure::SlidingDiverged);
}

}  // namespace tf::runtime
