// The begin of a run: starts, constraints among them, the first mode, and whether sensitivities have one.
#include "runtime/simulate/simulation_implementation.h"
#include "runtime/simulate/source_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace tf::runtime {

tf_status Simulation::Implementation::initialise(double startTime) {
  error_.clear();
  statistics_ = {};
  dynamics_.resetStatistics();
  selection_.resetStatistics();
  std::fill(selection_.grazingSpeeds().begin(), selection_.grazingSpeeds().end(), 0.0);
  impact_.resetStatistics();
  invariants_.start();
  redundancy_.start();
  time_ = startTime;
  std::fill(impulse_.begin(), impulse_.end(), 0.0);
  suggestedStep_ = 0;
  switchTime_ = jamTime_ = -std::numeric_limits<double>::infinity();
  openTimeEvent_ = std::numeric_limits<double>::quiet_NaN();
  lingeringSteps_ = 0;
  progress_.start(startTime, model_.nc + model_.nf + model_.ns);
  switchProgress_.start(model_.ns);
  rest_.reset(startTime);
  modeValid_ = false;
  mode_.closed.assign(model_.nc, 0);
  mode_.tangent.assign(model_.nt, Tangent::None);
  mode_.switches.clear();
  if (const tf_status status = takeStarts(); status != TF_OK)
    return status;
  if (const tf_status status = solveStart(); status != TF_OK)
    return status;
  selection_.setStepVariables(time_, state_.data(), mode_);
  if (std::string text = failures_.contactsAtStart(time_, state_.data()); !text.empty())
    return fail(std::move(text));
  energy_.reset();
  impact_.measureWork(owner_.options.energyBalance);
  values_.setEnergyBalance(nullptr);
  if (owner_.options.energyBalance) {
    energy_ = std::make_unique<EnergyBalance>(dynamics_);
    energy_->start(time_, state_.data());
    values_.setEnergyBalance(energy_.get());
  }
  dynamics_.setSlipAccuracy(0.05 * owner_.options.tolerance);
  integrators_.prepare(stepOptions());
  return settleStart();
}

// Errors of slips must be small against the disks of relaxed ones, whatever the tolerance is. The evaluation's point is the start.
SimulationOptions Simulation::Implementation::stepOptions() {
  constexpr double part = 0.01;
  SimulationOptions tightened = owner_.options;
  if (!hasRelaxedSlips(model_))
    return tightened;
  const auto limit = [&](const auto &element) {
    if (element.friction_form == TF_FRICTION_RELAXED)
      tightened.tolerance =
          std::min(tightened.tolerance, part * relaxedSlipRadius(at_.slip.data() + element.tangent_first + TF_RELAXED_STEADY_ROW));
  };
  at_.setPoint(time_, state_.data());
  at_.switchingOfAll(ModelEvaluation::Slips);
  std::for_each_n(model_.contacts, model_.nc, limit);
  std::for_each_n(model_.frictions, model_.nf, limit);
  return tightened;
}

tf_status Simulation::Implementation::takeStarts() {
  parameters_.assign(instance_.parameters().begin(), instance_.parameters().end());
  instance_.starts(time_, starts_);
  const Starts &starts = starts_;
  std::copy(starts.q.begin(), starts.q.end(), state_.begin());
  std::copy(starts.v.begin(), starts.v.end(), state_.begin() + model_.nq);
  std::copy(starts.z.begin(), starts.z.end(), state_.begin() + model_.nq + model_.nv);
  state_[at_.tauIndex()] = time_;
  inputs_.setDefaults(starts.u);
  if (std::string text = failures_.startValues(state_.data()); !text.empty())
    return fail(std::move(text));
  if (!at_.setParameters(parameters_.data()))
    return fail(failures_.singularMass());
  enterSegment();
  selection_.setStepVariables(time_, state_.data(), mode_);
  at_.measureScales(time_, state_.data());
  redundancy_.forgetChoice();
  if (std::string text = failures_.contactParameters(); !text.empty())
    return fail(std::move(text));
  return TF_OK;
}

tf_status Simulation::Implementation::solveStart() {
  sensitivities_.reset();
  isShareLost_ = areSensitivitiesLost_ = hasStopMoved_ = false;
  if (!owner_.options.sensitivities.empty()) {
    if (std::string text = failures_.relaxedSensitivities(); !text.empty())
      return fail(std::move(text));
    sensitivities_ = std::make_unique<Sensitivities>(dynamics_, instance_, inputs_, owner_.options.sensitivities);
    sensitivities_->start(time_);
    beforeSensitivities_.assign(owner_.options.sensitivities.size() * static_cast<std::size_t>(model_.variable_count),
                                std::numeric_limits<double>::quiet_NaN());
  }
  if (model_.nh == 0)
    return TF_OK;
  ConstrainedStart constraints(at_);
  const std::vector<double> given = state_;
  if (std::string text = constraints.solve(time_, state_.data()); !text.empty())
    return fail(std::move(text));
  const auto solve = [&constraints](double time, double *state) { return constraints.solve(time, state).empty(); };
  if (!sensitivities_)
    return TF_OK;
  if (!sensitivities_->propagate(solve, time_, given.data()) && !startsStayConsistent())
    return failSensitivities("the constraints' start");
  // Not of the last start nearby.
  at_.measureScales(time_, state_.data());
  return TF_OK;
}

// Starts that are all given cannot be corrected: they must go along the constraints.
bool Simulation::Implementation::startsStayConsistent() {
  constexpr double leaves = 1e-6;
  std::vector<double> change(2 * static_cast<std::size_t>(model_.nh));
  const auto residuals = [this](double time, double *state, double *values) {
    at_.setPoint(time, state);
    at_.constraintResiduals();
    for (int k = 0; k < model_.nk; ++k)
      for (int row = model_.constraints[k].row_first, end = row + model_.constraints[k].row_count; row < end; ++row) {
        *values++ = model_.constraints[k].holonomic ? at_.residual[row] : 0;
        *values++ = at_.residualRate[row];
      }
    return true;
  };
  for (int column = 0; column < sensitivities_->columnCount(); ++column)
    if (!sensitivities_->differentiate(residuals, time_, state_.data(), column, static_cast<int>(change.size()), change.data()) ||
        std::any_of(change.begin(), change.end(), [](double value) { return !(std::abs(value) <= leaves); }))
      return false;
  return true;
}

tf_status Simulation::Implementation::settleStart() {
  std::vector<Transition> &transitions = beginTransitions();
  before_ = state_;
  selection_.findTouching(time_, state_.data());
  const bool impact = !selection_.approaching().empty();
  // The values of the variables before an impact or a frictional impulse at the start time need a mode: all contacts open.
  if (owner_.onEvent && !selection_.touching().empty()) {
    Mode open;
    copyMode(open);
    dynamics_.start(open, time_, state_.data());
    values_.evaluate(time_, state_.data(), impulse_.data(), parameters_.data(), beforeValues_.data());
  }
  if (const tf_status status = settle(transitions); status != TF_OK)
    return status;
  if (sensitivities_)
    if (const tf_status status = checkStartDerivatives(); status != TF_OK)
      return status;
  if (impact || std::any_of(transitions.begin(), transitions.end(), [](const Transition &t) { return t.kind == TF_EVENT_PAINLEVE; }))
    report(transitions);
  return startConstraints();
}

// What speaks against derivatives at the start, by how some values of all contacts change with each parameter: `objection` has the name of
// the parameter and these changes, and gives an empty text where there is nothing.
tf_status Simulation::Implementation::checkStartColumns(int parts, const std::vector<double> &values, const StartObjection &objection) {
  const auto count = static_cast<int>(values.size());
  const auto read = [&](double time, double *state, double *out) {
    at_.setPoint(time, state);
    at_.switchingOfAll(parts);
    std::copy(values.begin(), values.end(), out);
    return true;
  };
  std::vector<double> change(values.size());
  for (int column = 0; column < sensitivities_->columnCount(); ++column) {
    if (!sensitivities_->differentiate(read, time_, state_.data(), column, count, change.data()))
      return failSensitivities("the start");
    if (const std::string text = objection(model_.variables[sensitivities_->variableOf(column)].name, change); !text.empty())
      return failSensitivities("the start: " + text);
  }
  return TF_OK;
}

// A gap that opens at the start takes a longer time to close than starts are apart, of the order of its root: there is no derivative.
tf_status Simulation::Implementation::checkStartDerivatives() {
  constexpr double opens = 1e-6;
  const auto opened = [this](const char *parameter, const std::vector<double> &change) -> std::string {
    for (int i = 0; i < model_.nc; ++i)
      if (const tf_contact &contact = model_.contacts[i]; mode_.closed[i] && std::abs(change[i]) > opens * at_.scales.gap(i, state_.data()))
        return fmt::format("'{}' opens contact '{}' {}, which is closed there,", parameter, contact.name, sourceOf(contact.location));
    return {};
  };
  const tf_status status = checkStartColumns(ModelEvaluation::Gaps, at_.gap, opened);
  return status == TF_OK ? checkStartingSlips() : status;
}

// A slip that starts with the run has been one in the other direction for starts to one side, with the opposite friction.
tf_status Simulation::Implementation::checkStartingSlips() {
  constexpr double moves = 1e-6;
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return failEvaluation();
  std::vector<int> starting;
  at_.switchingOfAll(ModelEvaluation::Slips);
  for (int j = 0; j < model_.nt; ++j)
    if (const Tangent tangent = mode_.tangent[j]; (tangent == Tangent::SlipPositive || tangent == Tangent::SlipNegative) &&
                                                  std::abs(at_.slip[j]) <= selection_.stillSlip(j, state_.data()) &&
                                                  at_.tangentForce[j] != 0)
      starting.push_back(j);
  if (starting.empty())
    return TF_OK;
  const auto started = [&](const char *parameter, const std::vector<double> &change) -> std::string {
    for (const int j : starting)
      if (std::abs(change[j]) > moves * at_.scales.slip(j, state_.data() + model_.nq))
        return fmt::format("'{}' moves {}, which starts to slip there,", parameter, elementText(model_, elementOfTangent(model_, j)));
    return {};
  };
  if (const tf_status status = checkStartColumns(ModelEvaluation::Slips, at_.slip, started); status != TF_OK)
    return status;
  return dynamics_.evaluate(time_, state_.data(), rate_.data()) ? TF_OK : failEvaluation();
}

}  // namespace tf::runtime
