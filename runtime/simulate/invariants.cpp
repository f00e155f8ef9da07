#include "runtime/simulate/invariants.h"

#include "runtime/contact/numbers.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

void Invariants::start() {
  gap_ = normalForce_ = {infinity, 0, -1};
  constraint_ = energy_ = {};
  largestNormalForce_ = 0;
}

void Invariants::observe(ModeDynamics &dynamics, bool hasAllGaps) {
  ModelEvaluation &at = dynamics.model();
  const tf_model &model = at.model();
  const double time = at.time();
  const bool isAtPole = dynamics.isAtPole();
  if (model.nc > 0 && !hasAllGaps)
    at.switching(ModelEvaluation::Gaps);
  for (int i = 0; i < model.nc; ++i) {
    if (at.gap[i] < gap_.value && (hasAllGaps || at.screen().isAwake(i)))
      gap_ = {at.gap[i], time, i};
    if (isAtPole)
      continue;
    // An open contact has no force: that is a value, too.
    double force = dynamics.mode().closed[i] ? dynamics.normalForce(i) : 0;
    if (force < std::min(0.0, normalForce_.value) && force >= -dynamics.forceRounding())
      force = 0;
    if (force < normalForce_.value)
      normalForce_ = {force, time, i};
    largestNormalForce_ = std::max(largestNormalForce_, force);
  }
  at.constraintResiduals();
  for (int k = 0; k < model.nk; ++k)
    for (int row = model.constraints[k].row_first; row < model.constraints[k].row_first + model.constraints[k].row_count; ++row)
      if (const double violation = std::max(std::abs(at.residual[row]), std::abs(at.residualRate[row])); violation > constraint_.value)
        constraint_ = {violation, time, k};
}

void Invariants::observeInside(const ModelEvaluation &at, double error) {
  const double *q = at.coordinates();
  for (int i = 0; i < at.model().nc; ++i)
    if (at.gap[i] < std::min(gap_.value, -error * at.scales.gap(i, q)))
      gap_ = {at.gap[i], at.time(), i};
}

void Invariants::observeEnergy(double error, double time) {
  if (error > energy_.value)
    energy_ = {error, time, -1};
}

}  // namespace tf::runtime
