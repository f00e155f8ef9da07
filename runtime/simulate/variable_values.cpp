#include "runtime/simulate/variable_values.h"

#include "runtime/contact/time_speed.h"

#include <algorithm>
#include <limits>

namespace tf::runtime {

VariableValues::VariableValues(ModeDynamics &dynamics)
    : dynamics_(dynamics), owner_(contactsOfTangents(dynamics.model().model())), rate_(dynamics.size()),
      outputs_(dynamics.model().model().no) {
  const tf_model &model = dynamics.model().model();
  for (const int pair : pairsOfTangents(model))
    isPaired_.push_back(pair >= 0);
  stickRows_.assign(model.nt, 1);
  const auto mark = [this](const auto &element) {
    if (element.friction_form == TF_FRICTION_POLYHEDRAL)
      stickRows_[element.tangent_first] = element.tangent_count;
  };
  std::for_each_n(model.contacts, model.nc, mark);
  std::for_each_n(model.frictions, model.nf, mark);
  for (int k = 0; k < model.variable_count; ++k)
    hasEnergies_ = hasEnergies_ || model.variables[k].kind == TF_KIND_KINETIC_ENERGY;
}

double VariableValues::energyTotal(double EnergyTotals::*total) const {
  return energy_ != nullptr ? energy_->totals().*total : std::numeric_limits<double>::quiet_NaN();
}

// (1 − α1)(1 − α2) = λ_n β / a_n (theory.md section 2).
double VariableValues::push(int contact) const {
  const ModelEvaluation &at = dynamics_.model();
  return dynamics_.mode().closed[contact] ? at.normalForce[contact] * dynamics_.timeSpeed() / at.rate[contact] : 0;
}

// λ_t = (1 − 2 α3) limit; of a slip with two components for each component of λ_t.
double VariableValues::slipStep(int row) const {
  const ModelEvaluation &at = dynamics_.model();
  if (dynamics_.mode().tangent[row] != Tangent::Stick && !isPaired_[row])
    return at.slip[row] > 0 ? 1 : at.slip[row] < 0 ? 0 : 0.5;
  const int contact = owner_[row];
  return slipStepVariable(at.tangentForce[row], contact >= 0 ? at.friction[contact] * at.normalForce[contact] : at.bound[row]);
}

// All directions of a polyhedral form stick.
bool VariableValues::sticks(int row) const {
  const auto first = dynamics_.mode().tangent.begin() + row;
  return std::all_of(first, first + stickRows_[row], [](Tangent tangent) { return tangent == Tangent::Stick; });
}

double VariableValues::value(const tf_variable &variable, double time, const double *state, const double *impulse,
                             const double *parameters) const {
  const ModelEvaluation &at = dynamics_.model();
  const tf_model &model = at.model();
  const int i = variable.index;
  switch (static_cast<tf_kind>(variable.kind)) {
  case TF_KIND_TIME:
    return time;
  case TF_KIND_NUMERICAL_TIME:
    return state[model.nq + model.nv + model.nz];
  case TF_KIND_COORDINATE:
    return state[i];
  case TF_KIND_VELOCITY:
    return state[model.nq + i];
  case TF_KIND_ACCELERATION:
    return at.acceleration[i];
  case TF_KIND_STATE:
    return state[model.nq + model.nv + i];
  case TF_KIND_STATE_DERIVATIVE:
    return at.stateRate[i];
  case TF_KIND_INPUT:
    return at.input[i];
  case TF_KIND_PARAMETER:
    return parameters[i];
  case TF_KIND_OUTPUT:
    return outputs_[i];
  case TF_KIND_GAP:
    return at.gap[i];
  case TF_KIND_NORMAL_FORCE:
    return at.normalForce[i];
  case TF_KIND_TANGENT_FORCE:
    return at.tangentForce[i];
  case TF_KIND_SLIP:
    return at.slip[i];
  case TF_KIND_CLOSED:
    return dynamics_.mode().closed[i];
  case TF_KIND_STICKING:
    return sticks(i) ? 1 : 0;
  case TF_KIND_IMPULSE:
    return impulse[i];
  case TF_KIND_TIME_SPEED:
    return dynamics_.timeSpeed();
  case TF_KIND_STEP_VARIABLE:
    return at.stepVariable[i];
  case TF_KIND_GAP_STEP:
    return dynamics_.mode().closed[i] ? 0 : 1;
  case TF_KIND_GAP_RATE_STEP:
    return dynamics_.mode().closed[i] ? 1 - push(i) : at.gapRate[i] > 0 ? 1 : 0;
  case TF_KIND_SLIP_STEP:
    return slipStep(i);
  case TF_KIND_PUSH:
    return push(i);
  case TF_KIND_THETA_BACKWARD:
    return owner_[i] < 0 ? 0 : push(owner_[i]) * slipStep(i);
  case TF_KIND_THETA_FORWARD:
    return owner_[i] < 0 ? 0 : push(owner_[i]) * (1 - slipStep(i));
  case TF_KIND_MULTIPLIER:
    return at.multiplier[i];
  case TF_KIND_KINETIC_ENERGY:
    return kinetic_;
  case TF_KIND_POTENTIAL_ENERGY:
    return potential_;
  case TF_KIND_FRICTION_LOSS:
    return energyTotal(&EnergyTotals::frictionLoss);
  case TF_KIND_IMPACT_LOSS:
    return energyTotal(&EnergyTotals::impactLoss);
  case TF_KIND_WORK:
    return energyTotal(&EnergyTotals::work);
  }
  return 0;
}

bool VariableValues::evaluate(double time, const double *state, const double *impulse, const double *parameters, double *all) {
  const bool good = dynamics_.evaluate(time, state, rate_.data());
  ModelEvaluation &at = dynamics_.model();
  const tf_model &model = at.model();
  at.setPoint(time, state);
  at.switchingOfAll();
  dynamics_.solveMultipliers();
  if (hasEnergies_) {
    double power = 0;
    at.energies(kinetic_, potential_, power);
  }
  if (model.no > 0)
    at.evaluateOutputs(outputs_.data());
  for (int k = 0; k < model.variable_count; ++k)
    all[k] = value(model.variables[k], time, state, impulse, parameters);
  return good;
}

}  // namespace tf::runtime
