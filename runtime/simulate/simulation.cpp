#include "runtime/simulate/simulation.h"

#include "runtime/simulate/simulation_implementation.h"
#include "runtime/simulate/source_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

Simulation::Implementation::Implementation(Simulation &owner, ModelInstance &instance, InputSignals &inputs)
    : owner_(owner), model_(instance.model()), instance_(instance), inputs_(inputs), at_(model_, inputs), dynamics_(at_),
      selection_(dynamics_), impact_(at_), rest_(dynamics_, selection_), values_(dynamics_), failures_(dynamics_, instance),
      integrators_(dynamics_), n_(at_.stateSize()), state_(n_), rate_(n_), before_(n_), impulse_(model_.nc),
      beforeValues_(model_.variable_count), detection_(dynamics_), redundancy_(at_), energyJump_(at_), mayStop_(model_.nt),
      contactMask_(model_.nc + model_.nf), interpolated_(n_) {
  for (Mode *mode : {&mode_, &previousMode_, &restingMode_}) {
    mode->closed.reserve(model_.nc);
    mode->tangent.reserve(model_.nt);
    mode->switches.reserve(model_.ns);
    mode->direction.reserve(model_.nt);
  }
}

tf_status Simulation::Implementation::fail(std::string text) {
  error_ = std::move(text);
  return TF_FAILED;
}

tf_status Simulation::Implementation::failAt(std::string_view text) { return fail(fmt::format("{} at t = {:.10g}", text, time_)); }

tf_status Simulation::Implementation::failSensitivities(std::string_view where) {
  areSensitivitiesLost_ = true;
  return failAt(fmt::format("the sensitivities cannot be continued over {}", where));
}

tf_status Simulation::Implementation::failEvaluation() {
  const std::string text = failures_.evaluation();
  return fail(rapidSwitch() + text);
}

// What may be the cause of a failure at (time_, state_): a switch that changes ever faster, with its condition at zero. Else empty.
std::string Simulation::Implementation::rapidSwitch() {
  at_.setPoint(time_, state_.data());
  at_.switching(ModelEvaluation::Conditions);
  for (int j = 0; j < model_.ns; ++j)
    if (switchProgress_.isRapid(j, time_) && std::abs(at_.condition[j]) <= owner_.options.tolerance)
      return switchesWithoutEnd(j) + ": ";
  return {};
}

std::string Simulation::Implementation::switchesWithoutEnd(int j) const {
  return fmt::format("no consistent continuation: '{}' {} switches without end", model_.switches[j].text,
                     sourceOf(model_.switches[j].location));
}

// The dynamics has been started in mode_ at (time_, state_) and rate_ is dy/dt there.
void Simulation::Implementation::startMode() {
  integrators_.useForNewMode(rest_.bouncesLow(time_));
  startIntegrator(GapsAtStart::Unknown);
}

// The same, but the mode is the one before.
void Simulation::Implementation::resumeMode() {
  integrators_.useForNewMode(rest_.bouncesLow(time_));
  startIntegrator(GapsAtStart::AsBefore);
}

void Simulation::Implementation::startIntegrator(GapsAtStart gaps) {
  SmoothIntegrator &integrator = integrators_.current();
  const double part = 0.5 * selection_.tolerances().velocity;
  detection_.setIntegrator(integrator);
  if (gaps == GapsAtStart::Unknown)
    detection_.restart(time_, part);
  else
    detection_.resume(time_, part);
  integrator.setSwitchTime(switchTime_);
  integrator.start(time_, state_.data(), rate_.data(), suggestedStep_);
  detection_.watchStart();
}

// Another integrator goes on with the mode.
bool Simulation::Implementation::takeOver(SmoothIntegrator &integrator, IntegratorReason reason) {
  integrators_.use(integrator, reason);
  detection_.setIntegrator(integrator);
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return false;
  integrator.setSwitchTime(switchTime_);
  integrator.start(time_, state_.data(), rate_.data(), 0);
  detection_.watchStart();
  return true;
}

void Simulation::Implementation::note(tf_note_kind kind, double time, const std::string &text) {
  if (owner_.onNote)
    owner_.onNote({time, state_[at_.tauIndex()], kind, text.c_str(), state_.data()});
}

void Simulation::Implementation::enterSegment() {
  const double next = inputs_.nextBreakpoint(time_);
  at_.setSegment(std::isfinite(next) ? 0.5 * (time_ + next) : time_ + std::max(1.0, std::abs(time_)));
  inputRevision_ = inputs_.revision();
}

// The state becomes that of the end of the integrator's step.
tf_status Simulation::Implementation::commit() {
  SmoothIntegrator &integrator = integrators_.current();
  if (dynamics_.metNegativeFriction())
    if (const tf_status status = checkFriction(); status != TF_OK)
      return status;
  if (const tf_status status = checkConstraints(); status != TF_OK)
    return status;
  const bool isSampled = nextSample_ < integrator.endTime();
  // Directions that are held where a slip stops do not turn for motions nearby, whose slips do.
  if (sensitivities_)
    dynamics_.holdDirections(0);
  const int jumping = sensitivities_ ? jumpingRate() : -1;
  const bool differentiated = passSamples();
  const double begin = time_;
  if (const std::string text = integrators_.account(integrator.endTime() - begin, statistics_); !text.empty())
    note(TF_NOTE_INTEGRATOR, begin, text);
  time_ = integrator.endTime();
  std::copy_n(integrator.end(), n_, state_.begin());
  std::copy_n(integrator.endRate(), n_, rate_.begin());
  if (!detection_.isCut())
    suggestedStep_ = integrators_.primaryIsCurrent() ? integrator.suggestedStep() : 0;
  if ((energy_ || isSampled) && dynamics_.evaluate(time_, state_.data(), rate_.data()))
    observeInvariants(false);
  if (!differentiated)
    return failSensitivities(
        sensitivities_->isShareUnknown()
            ? "a motion that depends on how redundant contacts share their load within the friction of those that stick,"
            : "the step that ends");
  if (jumping >= 0)
    return failSensitivities(fmt::format("a jump of '{}' that no event shows, as `noEvent` and `smooth` hide it,", nameOfRate(jumping)));
  if (isShareLost_ && time_ - begin > owner_.options.tolerance * std::max(1.0, time_ - progress_.begin))
    return failSensitivities("contacts that come to rest while others slide and the motion depends on how they share their load,");
  noteRedundancy();
  return TF_OK;
}

// Of an acceleration or the derivative of a state.
std::string Simulation::Implementation::nameOfRate(int component) const {
  const int state = component - model_.nq - model_.nv;
  return state < 0 ? instance_.nameOf(TF_KIND_ACCELERATION, component - model_.nq) : instance_.nameOf(TF_KIND_STATE_DERIVATIVE, state);
}

// Shorter than any integrator can step: the state moves along its rate.
bool Simulation::Implementation::skipTo(double limit) {
  const double h = limit - time_;
  if (h > 64 * std::numeric_limits<double>::epsilon() * std::abs(limit))
    return false;
  for (int i = 0; i < n_; ++i)
    state_[i] += h * rate_[i];
  time_ = limit;
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return false;
  resumeMode();
  return true;
}

// No integrator could make a step.
tf_status Simulation::Implementation::failStep(StepStatus status) {
  if (status == StepStatus::Unsolvable && dynamics_.failure() != EvaluationFailure::None)
    return failEvaluation();
  if (dynamics_.evaluate(time_, state_.data(), rate_.data()))
    if (const int contact = dynamics_.jammedContact(); contact >= 0)
      return jam(contact);
  // The equations end here.
  if (const double ahead = lookAhead(); !dynamics_.evaluate(ahead, interpolated_.data(), rate_.data()))
    return failEvaluation();
  return failAt(rapidSwitch() + fmt::format("the integrator cannot meet tolerance {:.3g}", owner_.options.tolerance));
}

// The first event of the integrator's step, which becomes shorter where it could not be searched as a whole; no guard: none.
tf_status Simulation::Implementation::searchStep(DetectedEvent &event) {
  SmoothIntegrator &integrator = integrators_.current();
  event = detection_.detect();
  while (event.guard < 0 && detection_.searchedTo() < integrator.endTime()) {
    if (!integrator.shorten(detection_.searchedTo()))
      return failStep(StepStatus::TooSmall);
    if (const tf_status projected = projectEnd(); projected != TF_OK)
      return projected;
    event = detection_.detect();
  }
  return TF_OK;
}

// Where a step without event ends with a guard that is no number, what happens before that, and results up to there, are those of shorter
// ones.
tf_status Simulation::Implementation::shortenToDefined(DetectedEvent &event) {
  constexpr double shortest = 1e-13;
  SmoothIntegrator &integrator = integrators_.current();
  while (event.guard < 0 && detection_.hasUndefined()) {
    const double begin = integrator.beginTime(), end = integrator.endTime(), half = begin + 0.5 * (end - begin);
    const std::string text = failures_.undefinedContact(end, integrator.end());
    if (text.empty())
      return TF_OK;
    if (end - begin <= shortest * std::max(1.0, std::abs(begin)) || !integrator.shorten(half))
      return fail(fmt::format("{} at t = {:.10g}", text, end));
    if (const tf_status projected = projectEnd(); projected != TF_OK)
      return projected;
    if (const tf_status status = searchStep(event); status != TF_OK)
      return status;
  }
  return TF_OK;
}

tf_status Simulation::Implementation::step(double limit) {
  if (skipTo(limit))
    return TF_OK;
  limit = std::min(limit, time_ + owner_.options.longestStep);
  if (const int guard = chatteringSlip(); guard >= 0)
    return stopLingering(guard, limit);
  // Where the interpolant is worse than the step, this ends at the sample.
  const double farthest = integrators_.current().holdsToleranceInside() ? limit : std::min(limit, nextSample_);
  StepStatus status = integrators_.current().step(detection_.stepLimit(farthest));
  if (const int guard = status != StepStatus::Done ? switchAhead() : -1; guard >= 0)
    return passSwitch(guard, limit);
  // This near to a pole of the forces another integrator would only follow their rounding.
  if (constexpr double near = 1e-8; status != StepStatus::Done && dynamics_.evaluate(time_, state_.data(), rate_.data()))
    if (const int contact = dynamics_.jammedContact(clearlyPressing, near); contact >= 0)
      return jam(contact);
  if (SmoothIntegrator *other = status != StepStatus::Done ? integrators_.afterFailure() : nullptr; other != nullptr) {
    if (!takeOver(*other, IntegratorReason::Failure))
      return failEvaluation();
    status = other->step(other->holdsToleranceInside() ? limit : std::min(limit, nextSample_));
  }
  if (status != StepStatus::Done)
    return failStep(status);
  integrators_.countStep(statistics_);
  if (const tf_status projected = projectEnd(); projected != TF_OK)
    return projected;
  if (leapsHeld_ && owner_.options.fixedStep <= 0)
    return endBeforeLeap(limit);
  DetectedEvent event;
  if (const tf_status searched = searchStep(event); searched != TF_OK)
    return searched;
  if (const tf_status shortened = shortenToDefined(event); shortened != TF_OK)
    return shortened;
  if (event.guard >= 0)
    return handle(event, limit);
  detection_.advance();
  if (const tf_status committed = commit(); committed != TF_OK)
    return committed;
  // As in resumeTurned, but that the integrator goes on.
  if (dynamics_.renewDirections(time_, state_.data())) {
    if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
      return failEvaluation();
    if (const int broken = detection_.brokenForce(); broken >= 0)
      return endMode(broken, -1, limit);
  }
  if (const int guard = lingeringSlip(); guard >= 0)
    return stopLingering(guard, limit);
  const bool bouncesAreOver = integrators_.isForLowBounces() && !rest_.bouncesLow(time_);
  if ((integrators_.launchIsOver() || bouncesAreOver) && !takeOver(integrators_.primary(), IntegratorReason::Primary))
    return failEvaluation();
  if (SmoothIntegrator *stiff = integrators_.forStiffness(); stiff != nullptr && !takeOver(*stiff, IntegratorReason::Stiffness))
    return failEvaluation();
  return TF_OK;
}

tf_status Simulation::Implementation::advanceTo(double time, double firstSample) {
  if (!modeValid_)
    return fail("the simulation has not been initialised");
  nextSample_ = firstSample;
  if (!error_.empty())
    if (const tf_status status = goOn(); status != TF_OK)
      return status;
  if (inputs_.revision() != inputRevision_) {
    if (const tf_status status = timeEvent(); status != TF_OK)
      return status;
  }
  while (time_ < time) {
    // Those that have been skipped, with a switch that is passed within the tolerance, are here as well.
    while (nextSample_ <= time_)
      nextSample_ = owner_.onSample(nextSample_);
    if (std::isnan(nextSample_))
      return TF_TERMINATED;
    const double breakpoint = inputs_.nextBreakpoint(time_);
    const double limit = std::min(time, breakpoint);
    if (const tf_status status = step(limit); status != TF_OK)
      return status;
    if (time_ >= breakpoint)
      if (const tf_status status = timeEvent(); status != TF_OK)
        return status;
  }
  return std::isnan(nextSample_) ? TF_TERMINATED : TF_OK;
}

void Simulation::Implementation::values(double *all) {
  values_.evaluate(time_, state_.data(), impulse_.data(), parameters_.data(), all);
  // Where a run has failed there may be no mode that goes on, whose forces would be admissible. Samples are as exact as the tolerance only.
  constexpr double tolerances = 10;
  if (error_.empty() && isInSample_)
    invariants_.observeInside(at_, tolerances * owner_.options.tolerance);
  else if (error_.empty())
    observeInvariants(true);
}

bool Simulation::Implementation::sensitivity(int column, double *all) {
  const auto evaluate = [this](double time, double *state, double *result) {
    return values_.evaluate(time, state, impulse_.data(), at_.parameters(), result);
  };
  if (sensitivities_ && !sensitivities_->isKnown()) {
    std::fill_n(all, model_.variable_count, std::numeric_limits<double>::quiet_NaN());
    return true;
  }
  if (!sensitivities_ || !sensitivities_->differentiate(evaluate, time_, state_.data(), column, model_.variable_count, all))
    return false;
  // Differences resolve small parts of the state less well than it is known itself.
  const double *state = sensitivities_->column(column);
  for (int k = 0; k < model_.variable_count; ++k) {
    const tf_variable &variable = model_.variables[k];
    if (variable.kind == TF_KIND_COORDINATE)
      all[k] = state[variable.index];
    else if (variable.kind == TF_KIND_VELOCITY)
      all[k] = state[model_.nq + variable.index];
    else if (variable.kind == TF_KIND_STATE)
      all[k] = state[model_.nq + model_.nv + variable.index];
  }
  return true;
}

// The dynamics has been evaluated at (time_, state_).
void Simulation::Implementation::observeInvariants(bool hasAllGaps) {
  invariants_.observe(dynamics_, hasAllGaps);
  if (energy_)
    invariants_.observeEnergy(energy_->error(time_, state_.data()), time_);
}

const tf_statistics &Simulation::Implementation::statistics() {
  statistics_.rejected_steps = statistics_.jacobians = statistics_.newton_iterations = 0;
  integrators_.addStatistics(statistics_);
  statistics_.evaluations = dynamics_.evaluations();
  statistics_.worst_residual = selection_.worstViolation();
  statistics_.worst_impact_residual = impact_.worstResidual();
  const Extreme &gap = invariants_.gap(), &force = invariants_.normalForce();
  const Extreme &constraint = invariants_.constraint(), &energy = invariants_.energy();
  statistics_.worst_gap = gap.value;
  statistics_.worst_gap_time = gap.time;
  statistics_.worst_gap_contact = gap.element;
  statistics_.worst_normal_force = force.value;
  statistics_.worst_normal_force_time = force.time;
  statistics_.worst_normal_force_contact = force.element;
  statistics_.largest_normal_force = invariants_.largestNormalForce();
  statistics_.worst_constraint = constraint.value;
  statistics_.worst_constraint_time = constraint.time;
  statistics_.worst_constraint_element = constraint.element;
  statistics_.worst_energy_error = energy.value;
  statistics_.worst_energy_error_time = energy.time;
  statistics_.estimated_energy_time = energy_ ? energy_->totals().estimatedTime : 0;
  return statistics_;
}

Simulation::Simulation(ModelInstance &instance, InputSignals &inputs)
    : implementation_(std::make_unique<Implementation>(*this, instance, inputs)) {}

Simulation::~Simulation() = default;

tf_status Simulation::initialise(double startTime) { return implementation_->initialise(startTime); }

tf_status Simulation::advanceTo(double time) { return advanceTo(time, std::numeric_limits<double>::infinity()); }

tf_status Simulation::advanceTo(double time, double firstSample) { return implementation_->advanceTo(time, firstSample); }

void Simulation::stop() { implementation_->nextSample_ = std::numeric_limits<double>::quiet_NaN(); }

double Simulation::time() const { return implementation_->time_; }

double Simulation::tau() const { return implementation_->state_.back(); }

void Simulation::values(double *all) { implementation_->values(all); }

std::vector<std::int32_t> Simulation::differentiatedBy() const {
  const Sensitivities *sensitivities = implementation_->sensitivities_.get();
  std::vector<std::int32_t> variables(sensitivities == nullptr ? 0 : static_cast<std::size_t>(sensitivities->columnCount()));
  for (std::size_t column = 0; column < variables.size(); ++column)
    variables[column] = sensitivities->variableOf(static_cast<int>(column));
  return variables;
}

bool Simulation::sensitivity(int column, double *all) { return implementation_->sensitivity(column, all); }

void Simulation::sensitivityBeforeEvent(int column, double *all) {
  const auto count = static_cast<std::size_t>(implementation_->model_.variable_count);
  std::copy_n(implementation_->beforeSensitivities_.begin() + static_cast<std::ptrdiff_t>(count * static_cast<std::size_t>(column)), count,
              all);
}

void Simulation::valuesBeforeEvent(double *all) {
  std::copy(implementation_->beforeValues_.begin(), implementation_->beforeValues_.end(), all);
}

long long Simulation::reportedPoints() const { return implementation_->reportedPoints_; }

const std::string &Simulation::errorText() const { return implementation_->error_; }

const tf_statistics &Simulation::statistics() const { return implementation_->statistics(); }

std::size_t Simulation::stateSize() const { return implementation_->stateSize(); }

void Simulation::save(void *buffer) const { implementation_->save(buffer); }

void Simulation::restore(const void *buffer) { implementation_->restore(buffer); }

}  // namespace tf::runtime
