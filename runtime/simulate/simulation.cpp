#include "runtime/simulate/simulation.h"

#include "runtime/integrate/cvode_integrator.h"
#include "runtime/integrate/dormand_prince.h"
#include "runtime/integrate/element_integrator.h"
#include "runtime/integrate/radau.h"
#include "runtime/simulate/constrained_start.h"
#include "runtime/simulate/energy_balance.h"
#include "runtime/simulate/event_detection.h"
#include "runtime/simulate/impact.h"
#include "runtime/simulate/invariants.h"
#include "runtime/simulate/mode_selection.h"
#include "runtime/simulate/rest_prediction.h"
#include "runtime/simulate/sensitivities.h"
#include "runtime/simulate/variable_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace tf::runtime {

namespace {

// Events without progress of physical time before a run is given up.
constexpr int mostEventsAtOneTime = 200;
// Events of slips of two components within so short a time, relative to the time, before a run is given up. Impacts that accumulate are no
// such case: they are carried through.
constexpr int mostEventsNearby = 1000;
constexpr double nearby = 1e-6;

// The sign of a NaN means nothing.
std::string_view nameOfNonFinite(double value) { return std::isnan(value) ? "NaN" : value > 0 ? "infinity" : "-infinity"; }

}  // namespace

class Simulation::Implementation {
public:
  Implementation(Simulation &owner, ModelInstance &instance, InputSignals &inputs)
      : owner_(owner), model_(instance.model()), instance_(instance), inputs_(inputs), at_(model_, inputs), dynamics_(at_),
        selection_(dynamics_), impact_(at_), rest_(dynamics_, selection_), values_(dynamics_), n_(at_.stateSize()), state_(n_), rate_(n_),
        before_(n_), pairOf_(pairsOfTangents(model_)), impulse_(model_.nc), beforeValues_(model_.variable_count) {}

  tf_status initialise(double startTime);
  tf_status advanceTo(double time);
  void values(double *all);
  bool sensitivity(int column, double *all);

  // Continuation state; plain data.
  [[nodiscard]] std::size_t stateSize() const;
  void save(void *buffer);
  void restore(const void *buffer);

  Simulation &owner_;
  const tf_model &model_;
  ModelInstance &instance_;
  InputSignals &inputs_;
  ModelEvaluation at_;
  ModeDynamics dynamics_;
  ModeSelection selection_;
  Impact impact_;
  RestPrediction rest_;
  VariableValues values_;
  int n_;

  double time_ = 0;
  std::vector<double> state_, rate_, before_;  // q, v, z, tau; its rate; state before the event that is being handled
  std::vector<int> pairOf_;                    // nt, see pairsOfTangents
  std::vector<double> impulse_;
  std::vector<double> beforeValues_, beforeSensitivities_;
  Mode mode_;
  bool modeValid_ = false;
  bool sensitivitiesAreGood_ = true;
  double suggestedStep_ = 0;
  std::uint64_t inputRevision_ = 0;
  int eventsHere_ = 0;  // since physical time last moved
  int eventsNearby_ = 0;
  double nearbyTime_ = 0;  // since when eventsNearby_ counts
  std::string error_;
  tf_statistics statistics_ = {};
  std::vector<double> parameters_;

  std::unique_ptr<SmoothIntegrator> primary_, fallback_;  // the fallback is made when it is needed first
  std::unique_ptr<SmoothIntegrator> launch_;   // follows slips of two components from zero, where the primary one is not a collocation
  std::unique_ptr<SmoothIntegrator> bounces_;  // follows low bounces where the primary one is CVODE, which starts with steps of low order
  bool mayFallBack_ = false;
  SmoothIntegrator *integrator_ = nullptr;
  std::unique_ptr<EventDetection> detection_;
  std::unique_ptr<EnergyBalance> energy_;  // where it is asked for
  Invariants invariants_;
  std::unique_ptr<Sensitivities> sensitivities_;  // where they are asked for

private:
  struct Transition {
    int kind;
    int element;
  };

  tf_status fail(std::string text);
  tf_status checkSupported();
  tf_status checkStart();
  tf_status solveStart();
  tf_status failSensitivities(std::string_view where);
  tf_status failEvaluation();
  std::string describeNonFinite();
  std::string describeNegativeFriction();
  void makeIntegrators();
  void useIntegrator(SmoothIntegrator &integrator);
  void startIntegrator();
  void startIntegrator(SmoothIntegrator &integrator);
  void enterSegment();
  tf_status settle(std::vector<Transition> &transitions, SwitchHint hint = {});
  tf_status freeze(std::vector<Transition> &transitions, int forced);
  [[nodiscard]] int elementOfTangent(int row) const;
  void compareModes(const Mode &from, const Mode &to, std::vector<Transition> &transitions) const;
  void beginEvent();
  void report(const std::vector<Transition> &transitions);
  bool locateStop(DetectedEvent &event);
  tf_status followTurn(const DetectedEvent &event);
  bool skipTo(double limit);
  SmoothIntegrator *fallback();
  bool fallBack(SmoothIntegrator &integrator);
  tf_status step(double limit);
  bool chatters();
  tf_status handle(DetectedEvent event, double limit);
  tf_status comeToRest(const RestPoint &point);
  tf_status jam(int contact);
  tf_status timeEvent();
  void commit();
  void observeInvariants();
  void countStep();
};

tf_status Simulation::Implementation::fail(std::string text) {
  error_ = std::move(text);
  return TF_FAILED;
}

tf_status Simulation::Implementation::checkSupported() {
  for (int i = 0; i < model_.nc; ++i) {
    const tf_contact &contact = model_.contacts[i];
    if (!(at_.restitution[i] >= 0 && at_.restitution[i] <= 1))
      return fail(fmt::format("contact '{}' has restitution {}; it must be between 0 and 1 ({}:{})", contact.name, at_.restitution[i],
                              contact.location.file, contact.location.line));
    if (!(at_.rate[i] > 0))
      return fail(fmt::format("contact '{}' has rate {}; it must be positive ({}:{})", contact.name, at_.rate[i], contact.location.file,
                              contact.location.line));
  }
  return TF_OK;
}

tf_status Simulation::Implementation::solveStart() {
  sensitivities_.reset();
  if (!owner_.options.sensitivities.empty()) {
    sensitivities_ = std::make_unique<Sensitivities>(dynamics_, instance_, inputs_, owner_.options.sensitivities);
    sensitivities_->start(time_);
    beforeSensitivities_.assign(owner_.options.sensitivities.size() * static_cast<std::size_t>(model_.variable_count),
                                std::numeric_limits<double>::quiet_NaN());
  }
  const auto constrained = [this](double time, double *state) { return ConstrainedStart(at_).solve(time, state).empty(); };
  const std::vector<double> given = state_;
  if (std::string text = ConstrainedStart(at_).solve(time_, state_.data()); !text.empty())
    return fail(std::move(text));
  if (sensitivities_ && model_.nh > 0 && !sensitivities_->propagate(constrained, time_, given.data()))
    return failSensitivities("the constraints' start");
  return TF_OK;
}

tf_status Simulation::Implementation::failSensitivities(std::string_view where) {
  return fail(fmt::format("the sensitivities cannot be continued over {} at t = {:.10g}", where, time_));
}

tf_status Simulation::Implementation::checkStart() {
  at_.setPoint(time_, state_.data());
  if (std::string text = describeNegativeFriction(); !text.empty())
    return fail(std::move(text));
  at_.switching(ModelEvaluation::Gaps);
  for (int i = 0; i < model_.nc; ++i) {
    const tf_contact &contact = model_.contacts[i];
    const double tolerance = 1e-9 * std::max(1.0, contact.nominal);
    if (!std::isfinite(at_.gap[i]))
      return fail(fmt::format("'{}.gap' is {} at the start ({}:{})", contact.name, nameOfNonFinite(at_.gap[i]), contact.location.file,
                              contact.location.line));
    if (at_.gap[i] < -tolerance)
      return fail(fmt::format("contact '{}' starts with a penetration of {:.6g} ({}:{})", contact.name, -at_.gap[i], contact.location.file,
                              contact.location.line));
  }
  return TF_OK;
}

// The first contact or friction element whose coefficient or bound is negative at the evaluation's point, empty if there is none.
std::string Simulation::Implementation::describeNegativeFriction() {
  const std::vector<std::uint8_t> all(model_.nc + model_.nf, 1);
  at_.contactTerms(all.data());
  for (int i = 0; i < model_.nc; ++i)
    if (at_.friction[i] < 0)
      return fmt::format("the friction coefficient of contact '{}' is {:.6g}, it cannot be negative ({}:{})", model_.contacts[i].name,
                         at_.friction[i], model_.contacts[i].location.file, model_.contacts[i].location.line);
  for (int i = 0; i < model_.nf; ++i)
    if (const double bound = at_.bound[model_.frictions[i].tangent_first]; bound < 0)
      return fmt::format("the bound of friction element '{}' is {:.6g}, it cannot be negative ({}:{})", model_.frictions[i].name, bound,
                         model_.frictions[i].location.file, model_.frictions[i].location.line);
  return {};
}

std::string Simulation::Implementation::describeNonFinite() {
  const auto place = [&](tf_kind kind, int index) {
    const std::int32_t variable = instance_.variableOf(kind, index);
    const std::string name = instance_.nameOf(kind, index);
    if (variable < 0)
      return fmt::format("'{}'", name);
    const tf_location &where = model_.variables[variable].location;
    return fmt::format("'{}' ({}:{})", name, where.file != nullptr ? where.file : "", where.line);
  };
  for (int i = 0; i < model_.nz; ++i)
    if (!std::isfinite(at_.stateRate[i]))
      return fmt::format("{} in {}", nameOfNonFinite(at_.stateRate[i]), place(TF_KIND_STATE_DERIVATIVE, i));
  for (int i = 0; i < model_.nv; ++i)
    if (!std::isfinite(at_.force[i]) || !std::isfinite(at_.massMatrix[i * model_.nv + i]))
      return fmt::format("{} in {}", nameOfNonFinite(std::isfinite(at_.force[i]) ? at_.massMatrix[i * model_.nv + i] : at_.force[i]),
                         place(TF_KIND_ACCELERATION, i));
  return "a value that is not finite";
}

tf_status Simulation::Implementation::failEvaluation() {
  const double time = at_.time();
  switch (dynamics_.failure()) {
  case EvaluationFailure::SingularMass: {
    const int row = std::max(at_.mobility.mass().failedRow(), 0);
    return fail(fmt::format("the mass matrix is singular at t = {:.10g}: no inertia acts on '{}'", time,
                            instance_.nameOf(model_.nq == model_.nv ? TF_KIND_COORDINATE : TF_KIND_VELOCITY, row)));
  }
  case EvaluationFailure::SingularContact:
    return fail(fmt::format("the contact forces have no solution at t = {:.10g}", time));
  case EvaluationFailure::SlidingDiverged:
    return fail(fmt::format("the sliding mode of the switches has no solution at t = {:.10g}", time));
  case EvaluationFailure::NegativeFriction:
    return fail(fmt::format("{} at t = {:.10g}", describeNegativeFriction(), time));
  default:
    return fail(fmt::format("{} at t = {:.10g}", describeNonFinite(), time));
  }
}

void Simulation::Implementation::makeIntegrators() {
  const SimulationOptions &wanted = owner_.options;
  IntegratorSettings settings;
  settings.tolerance = wanted.tolerance;
  settings.fixedStep = wanted.fixedStep;
  dynamics_.setSlipAccuracy(0.05 * wanted.tolerance);
  settings.scale.assign(n_, 1.0);
  for (int k = 0; k < model_.variable_count; ++k) {
    const tf_variable &variable = model_.variables[k];
    const double nominal = std::abs(variable.nominal) > 0 ? std::abs(variable.nominal) : 1;
    if (variable.kind == TF_KIND_COORDINATE)
      settings.scale[variable.index] = nominal;
    else if (variable.kind == TF_KIND_VELOCITY)
      settings.scale[model_.nq + variable.index] = nominal;
    else if (variable.kind == TF_KIND_STATE)
      settings.scale[model_.nq + model_.nv + variable.index] = nominal;
  }
  const int stages = wanted.stages > 0 ? wanted.stages : wanted.tolerance < 1e-5 ? 4 : 3;
  primary_.reset();
  fallback_.reset();
  bounces_.reset();
  if (wanted.integrator == TF_CVODE)
    primary_ = std::make_unique<CvodeIntegrator>(dynamics_, settings);
  else if (wanted.integrator == TF_STEP || (wanted.integrator == TF_AUTO && wanted.stages > 0))
    primary_ = std::make_unique<ElementIntegrator>(dynamics_, settings, std::make_unique<Radau>(n_, stages));
  else
    primary_ = std::make_unique<ElementIntegrator>(dynamics_, settings, std::make_unique<DormandPrince>(n_));
  const std::vector<int> pairs = pairsOfTangents(model_);
  launch_.reset();
  if (wanted.integrator != TF_STEP && std::any_of(pairs.begin(), pairs.end(), [](int first) { return first >= 0; }))
    launch_ = std::make_unique<ElementIntegrator>(dynamics_, settings, std::make_unique<Radau>(n_, 4));
  mayFallBack_ = wanted.integrator != TF_CVODE && wanted.fixedStep <= 0;
  if (wanted.integrator == TF_CVODE)
    bounces_ = std::make_unique<ElementIntegrator>(dynamics_, settings, std::make_unique<DormandPrince>(n_));
  detection_ = std::make_unique<EventDetection>(dynamics_, *primary_);
  integrator_ = primary_.get();
}

void Simulation::Implementation::useIntegrator(SmoothIntegrator &integrator) {
  integrator_ = &integrator;
  detection_->setIntegrator(integrator);
}

// The dynamics has been started in mode_ at (time_, state_) and rate_ is dy/dt there.
// A slip of two components that starts from zero finds the direction of its friction within instants, in which the tolerance does not see
// it: for collocation, whose stages obey the law of friction exactly.
void Simulation::Implementation::startIntegrator() { startIntegrator(launch_ && dynamics_.launches() ? *launch_ : *primary_); }

void Simulation::Implementation::startIntegrator(SmoothIntegrator &integrator) {
  useIntegrator(integrator);
  detection_->restart(time_, 0.5 * selection_.velocityTolerance(state_.data()));
  integrator_->start(time_, state_.data(), rate_.data(), suggestedStep_);
  detection_->watchStart();
}

void Simulation::Implementation::enterSegment() {
  const double next = inputs_.nextBreakpoint(time_);
  at_.setSegment(std::isfinite(next) ? 0.5 * (time_ + next) : time_ + std::max(1.0, std::abs(time_)));
  inputRevision_ = inputs_.revision();
}

tf_status Simulation::Implementation::initialise(double startTime) {
  error_.clear();
  statistics_ = {};
  dynamics_.resetStatistics();
  selection_.resetStatistics();
  invariants_.start();
  time_ = startTime;
  parameters_.assign(instance_.parameters().begin(), instance_.parameters().end());
  const Starts starts = instance_.starts(startTime);
  std::copy(starts.q.begin(), starts.q.end(), state_.begin());
  std::copy(starts.v.begin(), starts.v.end(), state_.begin() + model_.nq);
  std::copy(starts.z.begin(), starts.z.end(), state_.begin() + model_.nq + model_.nv);
  state_[at_.tauIndex()] = startTime;
  inputs_.setDefaults(starts.u);
  std::fill(impulse_.begin(), impulse_.end(), 0.0);
  suggestedStep_ = 0;
  eventsHere_ = eventsNearby_ = 0;
  nearbyTime_ = startTime;
  rest_.reset();
  modeValid_ = false;
  mode_.closed.assign(model_.nc, 0);
  mode_.tangent.assign(model_.nt, Tangent::None);
  mode_.switches.clear();
  for (int i = 0; i < n_; ++i)
    if (!std::isfinite(state_[i]))
      return fail(fmt::format("the start of '{}' is {}",
                              i < model_.nq               ? instance_.nameOf(TF_KIND_COORDINATE, i)
                              : i < model_.nq + model_.nv ? instance_.nameOf(TF_KIND_VELOCITY, i - model_.nq)
                                                          : instance_.nameOf(TF_KIND_STATE, i - model_.nq - model_.nv),
                              nameOfNonFinite(state_[i])));
  if (!at_.setParameters(parameters_.data()))
    return fail(fmt::format(
        "the mass matrix is singular: no inertia acts on '{}'",
        instance_.nameOf(model_.nq == model_.nv ? TF_KIND_COORDINATE : TF_KIND_VELOCITY, std::max(at_.mobility.mass().failedRow(), 0))));
  enterSegment();
  if (const tf_status status = checkSupported(); status != TF_OK)
    return status;
  if (const tf_status status = solveStart(); status != TF_OK)
    return status;
  if (const tf_status status = checkStart(); status != TF_OK)
    return status;
  energy_.reset();
  values_.setEnergyBalance(nullptr);
  if (owner_.options.energyBalance) {
    energy_ = std::make_unique<EnergyBalance>(dynamics_);
    energy_->start(time_, state_.data());
    values_.setEnergyBalance(energy_.get());
  }
  makeIntegrators();
  // The state of the variables before an impact or a frictional impulse at the start time needs a mode: all contacts open.
  std::vector<Transition> transitions;
  before_ = state_;
  const bool impact = !selection_.touching(time_, state_.data(), true).empty();
  if (owner_.onEvent && !selection_.touching(time_, state_.data(), false).empty()) {
    Mode open = mode_;
    open.switches.assign(model_.ns, Switch::Zero);
    dynamics_.start(open, time_, state_.data());
    values_.evaluate(time_, state_.data(), impulse_.data(), parameters_.data(), beforeValues_.data());
  }
  if (const tf_status status = settle(transitions); status != TF_OK)
    return status;
  statistics_.redundant_constraints = model_.nh - at_.mobility.rank();
  if (impact || std::any_of(transitions.begin(), transitions.end(), [](const Transition &t) { return t.kind == TF_EVENT_PAINLEVE; }))
    report(transitions);
  return TF_OK;
}

// From the state at time_ to a mode that can go on: impacts until nothing approaches, then the mode. Transitions are appended.
tf_status Simulation::Implementation::settle(std::vector<Transition> &transitions, SwitchHint hint) {
  const Mode previous = mode_;
  for (int pass = 0; pass < 50; ++pass) {
    Selection selection = selection_.select(time_, state_.data(), mode_, hint);
    ++statistics_.contact_solves;
    switch (selection.status) {
    case SelectionStatus::Impact:
      if (const tf_status status = freeze(transitions, -1); status != TF_OK)
        return status;
      continue;
    case SelectionStatus::FrictionalImpulse:
      transitions.push_back({TF_EVENT_PAINLEVE, selection.contact});
      if (const tf_status status = freeze(transitions, selection.contact); status != TF_OK)
        return status;
      continue;
    case SelectionStatus::Failed:
      if (selection.text.empty())
        return failEvaluation();
      return fail(fmt::format("{} at t = {:.10g}", selection.text, time_));
    case SelectionStatus::Selected:
      break;
    }
    mode_ = std::move(selection.mode);
    modeValid_ = true;
    std::copy(selection_.rate().begin(), selection_.rate().end(), rate_.begin());
    // What was taken for zero within the selection's tolerance becomes zero now, not in the first step, where it would pass for motion.
    if (dynamics_.project(state_.data(), integrator_->settings().scale.data()) > 1e-15 &&
        !dynamics_.evaluate(time_, state_.data(), rate_.data()))
      return failEvaluation();
    if (selection.indeterminate)
      transitions.push_back({TF_EVENT_PAINLEVE, selection.contact});
    compareModes(previous, mode_, transitions);
    if (sensitivities_)
      sensitivities_->endEvent(rate_.data());
    startIntegrator();
    return TF_OK;
  }
  return fail(fmt::format("no consistent continuation after the impact at t = {:.10g}", time_));
}

tf_status Simulation::Implementation::freeze(std::vector<Transition> &transitions, int forced) {
  const std::vector<int> contacts = selection_.touching(time_, state_.data(), false);
  const std::vector<int> approaching = selection_.touching(time_, state_.data(), true);
  std::vector<double> incoming;
  if (energy_)
    incoming = state_;
  if (sensitivities_) {
    std::vector<double> ignored(model_.nc);
    const auto impact = [&](double time, double *state) { return impact_.apply(time, state, contacts, forced, ignored.data()); };
    if (!sensitivities_->propagate(impact, time_, state_.data()))
      return failSensitivities("the impact");
  }
  if (!impact_.apply(time_, state_.data(), contacts, forced, impulse_.data()))
    return fail(fmt::format("{} at t = {:.10g}", impact_.text(), time_));
  if (energy_)
    energy_->addImpact(time_, incoming.data(), state_.data(), impact_.boundaryWork());
  ++statistics_.frozen_phases;
  statistics_.breakpoints += impact_.breakpoints();
  for (int i : approaching)
    transitions.push_back({TF_EVENT_IMPACT, i});
  return TF_OK;
}

// Of events: the contact, or nc + friction element, of a tangential row.
int Simulation::Implementation::elementOfTangent(int row) const {
  const auto has = [row](const auto &element) {
    return row >= element.tangent_first && row < element.tangent_first + element.tangent_count;
  };
  for (int i = 0; i < model_.nc; ++i)
    if (has(model_.contacts[i]))
      return i;
  for (int f = 0; f < model_.nf; ++f)
    if (has(model_.frictions[f]))
      return model_.nc + f;
  return -1;
}

void Simulation::Implementation::compareModes(const Mode &from, const Mode &to, std::vector<Transition> &transitions) const {
  for (int i = 0; i < model_.nc; ++i)
    if (from.closed[i] != to.closed[i])
      transitions.push_back({to.closed[i] ? TF_EVENT_CLOSING : TF_EVENT_OPENING, i});
  for (int j = 0; j < model_.nt; ++j) {
    const Tangent a = from.tangent[j], b = to.tangent[j];
    if (a == b || b == Tangent::None || (pairOf_[j] >= 0 && pairOf_[j] < j))
      continue;
    const int element = elementOfTangent(j);
    if (b == Tangent::Stick)
      transitions.push_back({TF_EVENT_STICK, element});
    else if (a == Tangent::Stick)
      transitions.push_back({TF_EVENT_SLIP, element});
    else if (a != Tangent::None)
      transitions.push_back({TF_EVENT_SLIP_REVERSAL, element});
  }
  if (from.switches.empty())
    return;
  for (int j = 0; j < model_.ns; ++j) {
    if (from.switches[j] == to.switches[j])
      continue;
    const int kind = to.switches[j] == Switch::Sliding           ? TF_EVENT_SLIDING
                     : model_.switches[j].kind == TF_SWITCH_TIME ? TF_EVENT_TIME
                                                                 : TF_EVENT_STATE;
    transitions.push_back({kind, model_.nc + model_.nf + j});
  }
}

// Remembers the point before an event; the state is the one just before it.
void Simulation::Implementation::beginEvent() {
  before_ = state_;
  if (!owner_.onEvent)
    return;
  values_.evaluate(time_, state_.data(), impulse_.data(), parameters_.data(), beforeValues_.data());
  for (int column = 0; sensitivities_ && column < sensitivities_->columnCount(); ++column)
    if (double *all = beforeSensitivities_.data() + static_cast<std::ptrdiff_t>(column) * model_.variable_count; !sensitivity(column, all))
      std::fill_n(all, model_.variable_count, std::numeric_limits<double>::quiet_NaN());
}

void Simulation::Implementation::report(const std::vector<Transition> &transitions) {
  for (const Transition &transition : transitions) {
    ++statistics_.events[transition.kind];
    if (owner_.onEvent) {
      const tf_event event = {time_, state_[at_.tauIndex()], transition.kind, transition.element, before_.data(), state_.data()};
      owner_.onEvent(event);
    }
  }
}

void Simulation::Implementation::countStep() {
  ++statistics_.steps;
  if (integrator_ == fallback_.get() ||
      (owner_.options.integrator == TF_CVODE && integrator_ != bounces_.get() && integrator_ != launch_.get()))
    ++statistics_.cvode_steps;
  else if (integrator_ == launch_.get() || owner_.options.integrator == TF_STEP ||
           (owner_.options.integrator == TF_AUTO && owner_.options.stages > 0))
    ++statistics_.step_steps;
  else
    ++statistics_.explicit_steps;
}

void Simulation::Implementation::commit() {
  if (integrator_->endTime() > time_)
    eventsHere_ = 0;
  if (energy_)
    energy_->addStep(*integrator_);
  sensitivitiesAreGood_ = !sensitivities_ || sensitivities_->addStep(*integrator_);
  time_ = integrator_->endTime();
  std::copy_n(integrator_->end(), n_, state_.begin());
  std::copy_n(integrator_->endRate(), n_, rate_.begin());
  suggestedStep_ = integrator_ == primary_.get() ? integrator_->suggestedStep() : 0;
  if (energy_ && dynamics_.evaluate(time_, state_.data(), rate_.data()))
    observeInvariants();
}

tf_status Simulation::Implementation::timeEvent() {
  beginEvent();
  const double potential = energy_ ? energy_->energyAt(time_, state_.data()).potential : 0;
  enterSegment();
  if (energy_)
    energy_->addJump(energy_->energyAt(time_, state_.data()).potential - potential);
  rest_.restart();
  std::vector<Transition> transitions = {{TF_EVENT_TIME, -1}};
  if (const tf_status status = settle(transitions); status != TF_OK)
    return status;
  report(transitions);
  return TF_OK;
}

// Slips of two components stop and start again with tiny progress.
bool Simulation::Implementation::chatters() {
  if (std::none_of(model_.contacts, model_.contacts + model_.nc, [](const tf_contact &contact) { return contact.tangent_count > 1; }))
    return false;
  if (time_ > nearbyTime_ + nearby * std::max(1.0, std::abs(time_))) {
    nearbyTime_ = time_;
    eventsNearby_ = 0;
  }
  return ++eventsNearby_ > mostEventsNearby;
}

tf_status Simulation::Implementation::handle(DetectedEvent event, double limit) {
  if (chatters())
    return fail(fmt::format("no consistent continuation: slips stop and start again without end at t = {:.10g}", time_));
  const Guard guard = dynamics_.guards()[event.guard];
  const bool stops = guard.kind == GuardKind::SlipAlong;
  if (stops && !locateStop(event))
    return followTurn(event);
  if (!stops && !detection_->locate(event))
    return failEvaluation();
  dynamics_.project(integrator_->end(), integrator_->settings().scale.data(), stops ? event.guard : -1);
  commit();
  if (!sensitivitiesAreGood_)
    return failSensitivities("the step that ends");
  if (++eventsHere_ > mostEventsAtOneTime)
    return fail(fmt::format("no consistent continuation: {} events at t = {:.10g} without progress", eventsHere_, time_));
  // Other least-norm forces of redundant contacts: the same motion, no event.
  if (guard.kind == GuardKind::Force && dynamics_.evaluate(time_, state_.data(), rate_.data()) && dynamics_.rechoose(event.guard)) {
    dynamics_.evaluate(time_, state_.data(), rate_.data());
    startIntegrator();
    return TF_OK;
  }
  beginEvent();
  if (sensitivities_ && !dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return failEvaluation();
  if (sensitivities_ && !sensitivities_->beginEvent(time_, state_.data(), rate_.data(), event.guard))
    return failSensitivities("an event where a switching function touches zero");
  SwitchHint hint;
  if (guard.kind == GuardKind::StepLow || guard.kind == GuardKind::StepHigh)
    hint = {guard.index, guard.kind == GuardKind::StepHigh ? Switch::One : Switch::Zero};
  else if (guard.kind == GuardKind::Condition)
    hint = {guard.index, guard.sign > 0 ? Switch::Zero : Switch::One};
  std::vector<Transition> transitions;
  const int slipping = stops ? dynamics_.slipRow(event.guard) : -1;
  if (const tf_status status = settle(transitions, hint); status != TF_OK)
    return status;
  if (stops && mode_.tangent[slipping] == Tangent::SlipPositive)
    transitions.push_back({TF_EVENT_SLIP_REVERSAL, elementOfTangent(slipping)});
  report(transitions);
  if (std::none_of(transitions.begin(), transitions.end(), [](const Transition &t) { return t.kind == TF_EVENT_IMPACT; }))
    return TF_OK;
  const RestPoint *rest =
      rest_.afterImpact(time_, before_.data(), state_.data(), owner_.options.tolerance, integrator_->settings().scale.data());
  if (rest != nullptr && rest->time <= limit)
    return comeToRest(*rest);
  if (bounces_ && rest_.bouncesLow()) {
    if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
      return failEvaluation();
    startIntegrator(*bounces_);
  }
  return TF_OK;
}

// The end of infinitely many impacts: contacts close for good.
tf_status Simulation::Implementation::comeToRest(const RestPoint &point) {
  if (sensitivities_)
    return failSensitivities("infinitely many impacts");
  const double lastImpact = time_;
  const std::vector<double> afterImpact = state_;
  time_ = point.time;
  state_ = point.state;
  eventsHere_ = 0;
  for (int i = 0; i < model_.nc; ++i)
    impulse_[i] += point.impulse[i];
  Mode resting = mode_;
  for (const int i : point.contacts)
    resting.closed[i] = 1;
  for (const int j : point.sticking)
    resting.tangent[j] = Tangent::Stick;
  // Whether the contacts really stay closed is decided by settle(): a mode without admissible forces can still be projected onto.
  for (int pass = 0; pass < 3; ++pass) {
    dynamics_.start(resting, time_, state_.data());
    if (dynamics_.project(state_.data(), integrator_->settings().scale.data()) < 1e-14)
      break;
  }
  if (energy_)
    energy_->addImpacts(lastImpact, afterImpact.data(), time_, state_.data(), point.boundaryWork, point.frictionWork);
  if (!dynamics_.start(mode_, time_, state_.data()))
    return failEvaluation();
  beginEvent();
  std::vector<Transition> transitions;
  transitions.reserve(point.contacts.size());
  for (const int i : point.contacts)
    transitions.push_back({TF_EVENT_REST, i});
  if (const tf_status status = settle(transitions); status != TF_OK)
    return status;
  std::erase_if(transitions, [this](const Transition &t) { return t.kind == TF_EVENT_REST && !mode_.closed[t.element]; });
  report(transitions);
  return TF_OK;
}

// The slip of two components whose part along the reference direction falls to zero at the event: is it zero altogether there, far within
// the tolerance? Else it turns by a right angle. Where it hardly turns any more its direction is held, since the right-hand side is
// singular at zero; friction that has the direction of the step's begin leaves a rest of the size of the turn, which is bounded here too.
bool Simulation::Implementation::locateStop(DetectedEvent &event) {
  const IntegratorSettings &settings = integrator_->settings();
  double scale = 1;
  for (int i = 0; i < model_.nv; ++i)
    scale = std::max({scale, settings.scale[model_.nq + i], std::abs(integrator_->begin()[model_.nq + i])});
  const double allowed = std::max(0.05 * settings.tolerance * scale, 10 * selection_.velocityTolerance(integrator_->begin()));
  std::vector<double> state(n_);
  integrator_->interpolate(event.time, state.data());
  at_.setPoint(event.time, state.data());
  at_.switching(ModelEvaluation::Slips);
  const double speed = dynamics_.slipSpeed(event.guard);
  if (speed > 1e3 * allowed)
    return false;
  dynamics_.holdDirection(event.guard, true);
  if (detection_->locate(event)) {
    at_.setPoint(integrator_->endTime(), integrator_->end());
    at_.switching(ModelEvaluation::Slips);
    if (dynamics_.slipSpeed(event.guard) <= allowed)
      return true;
  }
  dynamics_.holdDirection(event.guard, false);
  if (speed > 10 * allowed)
    return false;
  // Other slips that have just begun may keep implicit equations from being solved to rounding: the interpolant is as good as the step.
  std::copy(state.begin(), state.end(), integrator_->end());
  integrator_->moveEnd(event.time);
  return dynamics_.evaluate(event.time, integrator_->end(), integrator_->endRate());
}

// The step ends where the slip has turned by no more than 60°, or on most of the way to zero; the next one has another reference direction.
tf_status Simulation::Implementation::followTurn(const DetectedEvent &event) {
  const double begin = integrator_->beginTime();
  double length = event.time - begin;
  for (bool good = false; !good;) {
    length *= 0.75;
    if (begin + length <= begin)
      return failEvaluation();
    if (!integrator_->shorten(begin + length))
      continue;
    at_.switching(ModelEvaluation::Slips);
    good = dynamics_.guardValue(event.guard) >= 0.5 * dynamics_.slipSpeed(event.guard);
  }
  dynamics_.project(integrator_->end(), integrator_->settings().scale.data());
  commit();
  suggestedStep_ = 0.5 * length;
  dynamics_.renewDirections(time_, state_.data());
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return failEvaluation();
  startIntegrator();
  return TF_OK;
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
  startIntegrator();
  return true;
}

SmoothIntegrator *Simulation::Implementation::fallback() {
  if (mayFallBack_ && !fallback_)
    fallback_ = std::make_unique<CvodeIntegrator>(dynamics_, primary_->settings());
  return fallback_.get();
}

// Another integrator takes over for the rest of the mode.
bool Simulation::Implementation::fallBack(SmoothIntegrator &integrator) {
  useIntegrator(integrator);
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return false;
  integrator.start(time_, state_.data(), rate_.data(), 0);
  detection_->watchStart();
  return true;
}

// The force of a contact grows beyond all bounds as D_s reaches zero (Génot and Brogliato, Eur. J. Mech. A/Solids 18, 1999): what follows
// is a frictional impulse that ends the slip.
tf_status Simulation::Implementation::jam(int contact) {
  if (sensitivities_)
    return failSensitivities("a contact force that grows beyond all bounds");
  if (++eventsHere_ > mostEventsAtOneTime)
    return fail(fmt::format("no consistent continuation: {} events at t = {:.10g} without progress", eventsHere_, time_));
  beginEvent();
  std::vector<Transition> transitions = {{TF_EVENT_PAINLEVE, contact}};
  if (const tf_status status = freeze(transitions, contact); status != TF_OK)
    return status;
  if (const tf_status status = settle(transitions); status != TF_OK)
    return status;
  report(transitions);
  return TF_OK;
}

tf_status Simulation::Implementation::step(double limit) {
  if (skipTo(limit))
    return TF_OK;
  StepStatus status = integrator_->step(limit);
  SmoothIntegrator *other = nullptr;
  if (status != StepStatus::Done)
    other = integrator_ == bounces_.get() || (integrator_ == launch_.get() && !mayFallBack_) ? primary_.get() : fallback();
  if (other != nullptr && integrator_ != other) {
    if (!fallBack(*other))
      return failEvaluation();
    status = integrator_->step(limit);
  }
  if (status == StepStatus::Unsolvable && dynamics_.failure() != EvaluationFailure::None)
    return failEvaluation();
  if (status != StepStatus::Done && dynamics_.evaluate(time_, state_.data(), rate_.data()))
    if (const int contact = dynamics_.jammedContact(); contact >= 0)
      return jam(contact);
  if (status != StepStatus::Done)
    return fail(fmt::format("the integrator cannot meet tolerance {:.3g} at t = {:.10g}", owner_.options.tolerance, time_));
  countStep();
  const double correction = dynamics_.project(integrator_->end(), integrator_->settings().scale.data());
  if (correction > 1e-13 && !dynamics_.evaluate(integrator_->endTime(), integrator_->end(), integrator_->endRate()))
    return failEvaluation();
  const DetectedEvent event = detection_->detect();
  if (event.guard >= 0)
    return handle(event, limit);
  detection_->advance();
  commit();
  dynamics_.renewDirections(time_, state_.data());
  if (!sensitivitiesAreGood_)
    return failSensitivities("the step that ends");
  if (integrator_ == launch_.get() && dynamics_.hasLaunched() && !fallBack(*primary_))
    return failEvaluation();
  if (owner_.options.integrator == TF_AUTO && mayFallBack_ && integrator_->isStiff() && !fallBack(*fallback()))
    return failEvaluation();
  return TF_OK;
}

tf_status Simulation::Implementation::advanceTo(double time) {
  if (!modeValid_)
    return fail("the simulation has not been initialised");
  if (inputs_.revision() != inputRevision_) {
    if (const tf_status status = timeEvent(); status != TF_OK)
      return status;
  }
  while (time_ < time) {
    const double breakpoint = inputs_.nextBreakpoint(time_);
    const double limit = std::min(time, breakpoint);
    if (const tf_status status = step(limit); status != TF_OK)
      return status;
    if (time_ >= breakpoint)
      if (const tf_status status = timeEvent(); status != TF_OK)
        return status;
  }
  return TF_OK;
}

void Simulation::Implementation::values(double *all) {
  values_.evaluate(time_, state_.data(), impulse_.data(), parameters_.data(), all);
  observeInvariants();
}

bool Simulation::Implementation::sensitivity(int column, double *all) {
  const auto evaluate = [this](double time, double *state, double *result) {
    return values_.evaluate(time, state, impulse_.data(), at_.parameters(), result);
  };
  return sensitivities_ && sensitivities_->differentiate(evaluate, time_, state_.data(), column, model_.variable_count, all);
}

// The dynamics has been evaluated at (time_, state_).
void Simulation::Implementation::observeInvariants() {
  invariants_.observe(dynamics_);
  if (energy_)
    invariants_.observeEnergy(energy_->error(time_, state_.data()), time_);
}

// numbers, state, impulses, what is known of the impacts, mode
std::size_t Simulation::Implementation::stateSize() const {
  return (3 + static_cast<std::size_t>(n_) + impulse_.size() + rest_.numberCount() + model_.nt) * sizeof(double) + sizeof(EnergyTotals) +
         static_cast<std::size_t>(model_.nc) + model_.nt + model_.ns;
}

void Simulation::Implementation::save(void *buffer) {
  auto *out = static_cast<unsigned char *>(buffer);
  const auto write = [&out](const void *data, std::size_t size) {
    if (size > 0)
      std::memcpy(out, data, size);
    out += size;
  };
  const double numbers[] = {time_, suggestedStep_, static_cast<double>(eventsHere_)};
  write(numbers, sizeof numbers);
  write(state_.data(), state_.size() * sizeof(double));
  write(impulse_.data(), impulse_.size() * sizeof(double));
  const EnergyTotals totals = energy_ ? energy_->totals() : EnergyTotals{};
  write(&totals, sizeof totals);
  std::vector<double> impacts(rest_.numberCount());
  rest_.write(impacts.data());
  write(impacts.data(), impacts.size() * sizeof(double));
  write(mode_.closed.data(), mode_.closed.size());
  write(mode_.tangent.data(), mode_.tangent.size());
  write(mode_.switches.data(), mode_.switches.size());
  mode_.direction.resize(model_.nt);
  write(mode_.direction.data(), mode_.direction.size() * sizeof(double));
  // The saved point is where both continuations begin anew.
  rest_.read(impacts.data());
  if (modeValid_ && dynamics_.start(mode_, time_, state_.data(), rate_.data()))
    startIntegrator();
}

void Simulation::Implementation::restore(const void *buffer) {
  const auto *in = static_cast<const unsigned char *>(buffer);
  const auto read = [&in](void *data, std::size_t size) {
    if (size > 0)
      std::memcpy(data, in, size);
    in += size;
  };
  double numbers[3];
  read(numbers, sizeof numbers);
  time_ = numbers[0];
  suggestedStep_ = numbers[1];
  eventsHere_ = static_cast<int>(numbers[2]);
  read(state_.data(), state_.size() * sizeof(double));
  read(impulse_.data(), impulse_.size() * sizeof(double));
  EnergyTotals totals;
  read(&totals, sizeof totals);
  if (energy_)
    energy_->restore(totals);
  std::vector<double> impacts(rest_.numberCount());
  read(impacts.data(), impacts.size() * sizeof(double));
  rest_.read(impacts.data());
  mode_.switches.resize(model_.ns);
  read(mode_.closed.data(), mode_.closed.size());
  read(mode_.tangent.data(), mode_.tangent.size());
  read(mode_.switches.data(), mode_.switches.size());
  mode_.direction.resize(model_.nt);
  read(mode_.direction.data(), mode_.direction.size() * sizeof(double));
  error_.clear();
  enterSegment();
  modeValid_ = dynamics_.start(mode_, time_, state_.data(), rate_.data());
  if (modeValid_)
    startIntegrator();
}

Simulation::Simulation(ModelInstance &instance, InputSignals &inputs)
    : implementation_(std::make_unique<Implementation>(*this, instance, inputs)) {}

Simulation::~Simulation() = default;

tf_status Simulation::initialise(double startTime) { return implementation_->initialise(startTime); }

tf_status Simulation::advanceTo(double time) { return implementation_->advanceTo(time); }

double Simulation::time() const { return implementation_->time_; }

double Simulation::tau() const { return implementation_->state_.back(); }

void Simulation::values(double *all) { implementation_->values(all); }

bool Simulation::sensitivity(int column, double *all) { return implementation_->sensitivity(column, all); }

void Simulation::sensitivityBeforeEvent(int column, double *all) {
  const auto count = static_cast<std::size_t>(implementation_->model_.variable_count);
  std::copy_n(implementation_->beforeSensitivities_.begin() + static_cast<std::ptrdiff_t>(count * static_cast<std::size_t>(column)), count,
              all);
}

void Simulation::valuesBeforeEvent(double *all) {
  std::copy(implementation_->beforeValues_.begin(), implementation_->beforeValues_.end(), all);
}

const std::string &Simulation::errorText() const { return implementation_->error_; }

const tf_statistics &Simulation::statistics() const {
  Implementation &run = *implementation_;
  tf_statistics &statistics = run.statistics_;
  statistics.rejected_steps = statistics.jacobians = statistics.newton_iterations = 0;
  for (const SmoothIntegrator *integrator : {run.primary_.get(), run.fallback_.get(), run.bounces_.get(), run.launch_.get()})
    if (integrator != nullptr) {
      statistics.rejected_steps += integrator->statistics().rejected;
      statistics.jacobians += integrator->statistics().jacobians;
      statistics.newton_iterations += integrator->statistics().iterations;
    }
  statistics.evaluations = run.dynamics_.evaluations();
  statistics.worst_residual = run.selection_.worstViolation();
  const Extreme &gap = run.invariants_.gap(), &force = run.invariants_.normalForce();
  const Extreme &constraint = run.invariants_.constraint(), &energy = run.invariants_.energy();
  statistics.worst_gap = gap.value;
  statistics.worst_gap_time = gap.time;
  statistics.worst_gap_contact = gap.element;
  statistics.worst_normal_force = force.value;
  statistics.worst_normal_force_time = force.time;
  statistics.worst_normal_force_contact = force.element;
  statistics.worst_constraint = constraint.value;
  statistics.worst_constraint_time = constraint.time;
  statistics.worst_constraint_element = constraint.element;
  statistics.worst_energy_error = energy.value;
  statistics.worst_energy_error_time = energy.time;
  return statistics;
}

std::size_t Simulation::stateSize() const { return implementation_->stateSize(); }

void Simulation::save(void *buffer) const { implementation_->save(buffer); }

void Simulation::restore(const void *buffer) { implementation_->restore(buffer); }

}  // namespace tf::runtime
