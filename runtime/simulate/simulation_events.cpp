// What happens at events: the choice of the mode that follows, switches, rest, jams.
#include "runtime/simulate/simulation_implementation.h"
#include "runtime/simulate/source_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

// At the state before the event, where the contacts have just been selected.
void Simulation::Implementation::readApproaches() {
  for (const int i : selection_.approaching())
    approaches_.push_back({i, -at_.gapRate[i]});
}

// From the state at time_ to a mode that can go on: impacts until nothing approaches, then the mode. Transitions are appended.
tf_status Simulation::Implementation::settle(std::vector<Transition> &transitions, EventHint hint) {
  constexpr int mostPasses = 50, mostImpulses = 40;
  int impulses = 0, forced = -1;  // of friction, `mostImpulses` of which have changed nothing, and the contact of the last one
  int stopped = 0;                // how often the mode has stopped contacts that it had taken for parting
  approaches_.clear();
  // An impulse makes another normal force, and touching contacts move.
  const auto freezeAt = [&](int contact) {
    hint.forceless = -1;
    hint.keepsOpen = false;
    return freeze(transitions, contact);
  };
  for (int pass = 0; pass < mostPasses; ++pass) {
    const Selection &selection = selection_.select(time_, state_.data(), mode_, hint);
    ++statistics_.contact_solves;
    switch (selection.status) {
    case SelectionStatus::Impact:
      if (pass == 0)
        readApproaches();
      if (const tf_status status = freezeAt(-1); status != TF_OK)
        return status;
      continue;
    case SelectionStatus::FrictionalImpulse:
      if (++impulses == mostImpulses) {
        std::vector<int> arrived;
        arrived.reserve(approaches_.size());
        for (const Approach &approach : approaches_)
          arrived.push_back(approach.contact);
        if (selection_.keepOpen(arrived, state_.data())) {
          hint.forceless = -1;
          hint.keepsOpen = false;
          continue;
        }
      }
      forced = selection.contact;
      if (const tf_status status = freezeAt(forced); status != TF_OK)
        return status;
      continue;
    case SelectionStatus::Failed:
      if (const std::string text = failures_.undefinedContact(time_, state_.data()); !text.empty())
        return failAt(text);
      if (selection.text.empty())
        return failEvaluation();
      return failAt(selection.text);
    case SelectionStatus::Selected: {
      bool moves = false;
      if (const tf_status status = holdSelected(selection, moves); status != TF_OK)
        return status;
      if (moves && stopped++ < model_.nc && selection_.hasStopped(time_, state_.data()))
        continue;
      return enterMode(selection, transitions);
    }
    }
  }
  if (const std::string text = failures_.undefinedContact(time_, state_.data()); !text.empty())
    return failAt(text);
  return failAt(forced < 0 ? "no consistent continuation after the impact"
                           : fmt::format("no consistent continuation after {} frictional impulses, the last of {}", impulses,
                                         elementText(model_, forced)));
}

// What was taken for zero within the selection's tolerance becomes zero now, not in the first step, where it would pass for motion.
// `moves`: the state does.
tf_status Simulation::Implementation::holdSelected(const Selection &selection, bool &moves) {
  constexpr double rounding = 1e-14;
  std::copy(selection_.rate().begin(), selection_.rate().end(), rate_.begin());
  moves = dynamics_.projectStart(time_, state_.data(), integrators_.current().settings().scale.data()) > rounding;
  if ((moves || selection.isSettled) && !dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return failEvaluation();
  if (moves)
    dynamics_.acceptContradiction();
  return TF_OK;
}

tf_status Simulation::Implementation::enterMode(const Selection &selection, std::vector<Transition> &transitions) {
  std::swap(previousMode_, mode_);
  mode_ = selection.mode;
  modeValid_ = true;
  // Where no contact is to blame, loads that redundant contacts may share in several ways leave the motion open.
  if (selection.indeterminate && selection.contact >= 0)
    transitions.push_back({TF_EVENT_PAINLEVE, selection.contact});
  compareModes(model_, previousMode_, mode_, transitions);
  // Motions nearby that still slip or move apart come to what the mode holds within an instant of the same order.
  if (sensitivities_) {
    const double *scale = integrators_.current().settings().scale.data();
    const auto stop = [this, scale](double time, double *state) { return dynamics_.stop(time, state, scale); };
    if (!sensitivities_->propagate(stop, time_, state_.data()) || !dynamics_.evaluate(time_, state_.data(), rate_.data()))
      return failSensitivities("the mode that begins");
    // That instant's impulses have shares, too, which are not those of the mode; where nothing can move afterwards they do not matter.
    const bool hasMoved = sensitivities_->hasMoved() || hasStopMoved_;
    hasStopMoved_ = false;
    isShareLost_ = (isShareLost_ && !dynamics_.holdsAll()) || (hasMoved && dynamics_.sharesMove());
    if (sensitivities_->isOneSided())
      return failSensitivities("an event at which those for larger and for smaller values of a parameter differ");
    // How the load is shared at the first instant of a slip depends on the direction that it is about to take.
    if (dynamics_.launches() && dynamics_.sharesMove())
      return failSensitivities("slips that start where redundant contacts share their load");
    sensitivities_->endEvent(rate_.data());
  }
  if (std::isinf(suggestedStep_) && !(mode_ == previousMode_))
    suggestedStep_ = 0;
  startMode();
  return TF_OK;
}

// Of events, −1 if there is none; `stopped` as in changeMode.
int Simulation::Implementation::elementOf(const Guard &guard, int stopped) const {
  switch (guard.kind) {
  case GuardKind::Gap:
    return guard.index;
  case GuardKind::Force:
    return dynamics_.contactOfMargin(guard.index);
  case GuardKind::Slip:
    return elementOfTangent(model_, guard.index);
  case GuardKind::SlipAlong:
    return elementOfTangent(model_, stopped);
  case GuardKind::Condition:
  case GuardKind::StepLow:
  case GuardKind::StepHigh:
    return model_.nc + model_.nf + guard.index;
  }
  return -1;
}

tf_status Simulation::Implementation::failWithoutProgress() {
  const auto named = std::find_if(transitions_.rbegin(), transitions_.rend(), [](const Transition &t) { return t.element >= 0; });
  const int element = named == transitions_.rend() ? lastElement_ : named->element;
  const std::string last = element < 0 ? std::string() : " of " + elementText(model_, element);
  return failAt(fmt::format("no consistent continuation: {} events since t = {:.10g}, the last{}", progress_.count, progress_.since, last));
}

std::vector<Transition> &Simulation::Implementation::beginTransitions() {
  transitions_.clear();
  return transitions_;
}

// Remembers the point before an event; the state is the one just before it.
void Simulation::Implementation::beginEvent() {
  before_ = state_;
  if (!owner_.onEvent) {
    // Forces at the event are what those after it are sought from, with values to be reported or without.
    if (dynamics_.hasPairs())
      dynamics_.evaluate(time_, state_.data(), rate_.data());
    return;
  }
  values_.evaluate(time_, state_.data(), impulse_.data(), parameters_.data(), beforeValues_.data());
  for (int column = 0; sensitivities_ && column < sensitivities_->columnCount(); ++column)
    if (double *all = beforeSensitivities_.data() + static_cast<std::ptrdiff_t>(column) * model_.variable_count; !sensitivity(column, all))
      std::fill_n(all, model_.variable_count, std::numeric_limits<double>::quiet_NaN());
}

void Simulation::Implementation::report(const std::vector<Transition> &transitions) {
  ++reportedPoints_;
  for (const Transition &transition : transitions) {
    ++statistics_.events[transition.kind];
    if (owner_.onEvent) {
      const tf_event event = {time_, state_[at_.tauIndex()], transition.kind, transition.element, before_.data(), state_.data()};
      owner_.onEvent(event);
    }
  }
}

tf_status Simulation::Implementation::timeEvent() {
  beginEvent();
  // After a failure energies before it are those of the first attempt: inputs are other ones by now.
  if (openTimeEvent_ != time_)
    beginSwitch();
  openTimeEvent_ = time_;
  enterSegment();
  rest_.restart();
  if (std::isinf(suggestedStep_))
    suggestedStep_ = 0;
  std::vector<Transition> &transitions = beginTransitions();
  transitions.push_back({TF_EVENT_TIME, -1});
  EventHint hint;
  hint.keepsOpen = true;
  if (const tf_status status = settle(transitions, hint); status != TF_OK)
    return status;
  openTimeEvent_ = std::numeric_limits<double>::quiet_NaN();
  if (const tf_status status = endSwitch(-1); status != TF_OK)
    return status;
  report(transitions);
  return TF_OK;
}

// Switches, or inputs, are about to take other values at (time_, state_).
void Simulation::Implementation::beginSwitch() {
  redundancy_.forgetChoice();
  if (model_.nv > 0 && (energy_ || model_.ns > 0))
    energyJump_.begin(time_, state_.data());
}

// They have. What that does to the potential energy is work of what turns them; switch j may not have turned by the motion itself then.
tf_status Simulation::Implementation::endSwitch(int j) {
  if (const tf_status status = startConstraints(); status != TF_OK)
    return status;
  if (model_.nv == 0 || !(energy_ || model_.ns > 0))
    return TF_OK;
  energyJump_.end(time_, state_.data());
  if (energyJump_.kineticJumps())
    return failAt(
        fmt::format("the velocity of a body jumps{}, which only an impulse may do",
                    j < 0 ? "" : fmt::format(" where '{}' {} switches", model_.switches[j].text, sourceOf(model_.switches[j].location))));
  if (j >= 0 && energyJump_.potentialJumps() && switchesByMotion(j))
    return failAt(
        fmt::format("the potential energy jumps by {:.6g} where '{}' {} switches, which no force does: a potential is a continuous "
                    "function of the coordinates",
                    energyJump_.ofPotential(), model_.switches[j].text, sourceOf(model_.switches[j].location)));
  if (energy_)
    energy_->addJump(energyJump_.ofPotential());
  return TF_OK;
}

// The condition depends on coordinates.
bool Simulation::Implementation::switchesByMotion(int j) {
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(model_.ns), 0);
  mask[static_cast<std::size_t>(j)] = 1;
  at_.setPoint(time_, state_.data());
  at_.switchGradients(mask.data());
  const double *row = at_.conditionGradient.data() + static_cast<std::ptrdiff_t>(j) * at_.columns();
  return std::any_of(row, row + model_.nq, [](double slope) { return slope != 0; });
}

// From the last good point after a failure, with other inputs, say. The failure may have been that of an event at this point.
tf_status Simulation::Implementation::goOn() {
  if (areSensitivitiesLost_)
    return TF_FAILED;
  error_.clear();
  if (inputs_.revision() != inputRevision_ || openTimeEvent_ == time_)
    return timeEvent();
  beginEvent();
  std::vector<Transition> &transitions = beginTransitions();
  EventHint hint;
  hint.keepsOpen = true;
  if (const tf_status status = settle(transitions, hint); status != TF_OK)
    return status;
  report(transitions);
  return TF_OK;
}

tf_status Simulation::Implementation::handle(DetectedEvent event, double limit) {
  constexpr double nearby = 1e-12, ulps = 8;  // behind an event, in time: of some times the time scale, and of what times are resolved to
  if (!progress_.add(time_))
    return failWithoutProgress();
  bool stops = dynamics_.guards()[event.guard].kind == GuardKind::SlipAlong;
  if (stops && !locateStop(event))
    return followTurn(event, limit);
  EventDetection::Location location = stops ? EventDetection::Location::Found : detection_.locate(event);
  for (int k = 0; k < model_.nc && location == EventDetection::Location::Found && detection_.findEarlier(event); ++k) {
    stops = false;
    dynamics_.holdDirections(0);
    location = detection_.locate(event);
  }
  if (location == EventDetection::Location::Unsolved ||
      (location == EventDetection::Location::Found && !stops && (!integrators_.current().isResolved() || jumpsAt(event))))
    return approach(event, limit);
  if (location == EventDetection::Location::Vanished)
    return endStep(event.time - integrators_.current().beginTime(), limit);
  // What switches with the velocity of a body that stops has the value at rest, if it can stay there.
  if (dynamics_.guards()[event.guard].kind == GuardKind::Condition)
    if (const int slip = slipThatStops(); slip >= 0)
      event.guard = slip;
  Guard guard = dynamics_.guards()[event.guard];
  SmoothIntegrator &integrator = integrators_.current();
  if (stops)
    dynamics_.projectStop(integrator.endTime(), integrator.end(), integrator.settings().scale.data(), event.guard, stopTolerance());
  else if (const tf_status status = projectEnd(); status != TF_OK)
    return status;
  // Each time the projection moves the guard by less, by orders of magnitude.
  constexpr int mostReturns = 3;
  for (int pass = 0; pass < mostReturns && !stops && detection_.returnToZero(event); ++pass)
    if (const tf_status status = projectEnd(); status != TF_OK)
      return status;
  if (stops && sensitivities_)
    findStopping(event.guard);
  const tf_status committed = commit();
  stopping_ = {};
  if (committed != TF_OK)
    return committed;
  // Other least-norm forces of redundant contacts: the same motion, no event, unless others of these fall to zero at once and none is left
  // to take over.
  for (std::size_t k = 0;
       guard.kind == GuardKind::Force && dynamics_.evaluate(time_, state_.data(), rate_.data()) && dynamics_.rechoose(event.guard); ++k) {
    const int other = k < dynamics_.guards().size() && dynamics_.evaluate(time_, state_.data(), rate_.data())
                          ? detection_.fallingForce(time_, state_.data(), rate_.data())
                          : -1;
    if (other < 0)
      return resumeTurned(limit);
    event.guard = other;
    guard = dynamics_.guards()[other];
  }
  if (guard.kind == GuardKind::Force && dynamics_.evaluate(time_, state_.data(), rate_.data()))
    if (const int contact = jamAt(event.guard); contact >= 0)
      return jam(contact);
  beginEvent();
  if (sensitivities_ && !dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return failEvaluation();
  if (const tf_status status = differentiateEvent(event.guard); status != TF_OK)
    return status;
  if (guard.kind == GuardKind::Condition && switchesFaintly(guard.index))
    return failAt(switchesWithoutEnd(guard.index));
  if (guard.kind == GuardKind::Condition)
    crossSwitch(event.guard,
                std::max(nearby * std::min(1.0, 100 * timeScale()), ulps * std::numeric_limits<double>::epsilon() * std::abs(time_)));
  return changeMode(guard, stops ? dynamics_.slipRow(event.guard) : -1, limit);
}

// The time that has passed since the start, at least a second, at most what the state's fastest part takes, by rate_, for a change of its
// own size.
double Simulation::Implementation::timeScale() const {
  const std::vector<double> &nominal = at_.scales.nominal();
  double scale = std::max(1.0, time_ - progress_.begin);
  for (int i = 0; i < at_.tauIndex(); ++i)
    if (rate_[i] != 0)
      scale = std::min(scale, std::max(nominal[i], std::abs(state_[i])) / std::abs(rate_[i]));
  return scale;
}

// The state that (time_, state_), moving on along rate_, reaches within what the tolerance leaves open, into interpolated_; its time.
double Simulation::Implementation::lookAhead() {
  const double ahead = owner_.options.tolerance * timeScale();
  for (int i = 0; i < n_; ++i)
    interpolated_[i] = state_[i] + ahead * rate_[i];
  return time_ + ahead;
}

// The guard of a switch that (time_, state_), moving on along its rate, reaches within what the tolerance leaves open; −1: none.
int Simulation::Implementation::switchAhead() {
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return -1;
  const std::vector<Guard> &guards = dynamics_.guards();
  at_.setPoint(lookAhead(), interpolated_.data());
  at_.switching(ModelEvaluation::Conditions);
  for (std::size_t k = 0; k < guards.size(); ++k)
    if (guards[k].kind == GuardKind::Condition && !guards[k].isHeld && dynamics_.guardValue(static_cast<int>(k)) < 0)
      return static_cast<int>(k);
  return -1;
}

// Moves the state along its rate until a switch's guard is below zero: the branch behind it may not be defined before. Returns how far, in
// time; zero where nothing up to `farthest` does, or nothing need be moved.
double Simulation::Implementation::crossSwitch(int guard, double farthest) {
  constexpr double resolution = std::numeric_limits<double>::epsilon();
  constexpr int bisections = 40;
  const auto isBehind = [&](double ahead) {
    for (int i = 0; i < n_; ++i)
      interpolated_[i] = state_[i] + ahead * rate_[i];
    at_.setPoint(time_ + ahead, interpolated_.data());
    at_.switching(ModelEvaluation::Conditions);
    return dynamics_.guardValue(guard) < 0;
  };
  if (isBehind(0))
    return 0;
  double low = 0, high = 0.5 * resolution * std::max(std::abs(time_), 1e-3);
  while (!isBehind(high)) {
    low = high;
    high *= 2;
    if (!(high <= farthest))
      return 0;
  }
  for (int k = 0; k < bisections && low > 0; ++k)
    (isBehind(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
  isBehind(high);
  std::copy_n(interpolated_.begin(), n_, state_.begin());
  return high;
}

// Equations may end with their branch, as a square root does where a switch keeps its argument positive: no step leads over the switch
// then. The mode ends right before it.
tf_status Simulation::Implementation::passSwitch(int guard, double limit) {
  if (!progress_.add(time_))
    return failWithoutProgress();
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return failEvaluation();
  beginEvent();
  if (const tf_status status = differentiateEvent(guard); status != TF_OK)
    return status;
  time_ += crossSwitch(guard, 2 * owner_.options.tolerance * timeScale());
  return changeMode(dynamics_.guards()[guard], -1, limit);
}

// The sensitivities at the zero of the guard. Contacts that close with it close together with it nearby, or there is no derivative.
tf_status Simulation::Implementation::differentiateEvent(int guard) {
  if (!sensitivities_)
    return TF_OK;
  if (dynamics_.isContradiction(guard) && dynamics_.sharesMove())
    return failSensitivities("the end of a load that redundant contacts share, some of which slide,");
  const std::vector<Guard> &all = dynamics_.guards();
  std::vector<int> guards = {guard};
  if (all[guard].kind == GuardKind::Gap) {
    selection_.findTouching(time_, state_.data());
    for (const int i : selection_.approaching())
      for (int k = 0; k < static_cast<int>(all.size()); ++k)
        if (k != guard && all[k].kind == GuardKind::Gap && all[k].index == i)
          guards.push_back(k);
  }
  switch (sensitivities_->beginEvent(time_, state_.data(), rate_.data(), guards)) {
  case EventDerivative::Exists:
    return TF_OK;
  case EventDerivative::Touches:
    return failSensitivities("an event where a switching function touches zero");
  case EventDerivative::Parts:
    break;
  }
  std::string names;
  for (const int k : guards) {
    const tf_contact &contact = model_.contacts[all[k].index];
    names += fmt::format("{}'{}' {}", names.empty() ? "" : ", ", contact.name, sourceOf(contact.location));
  }
  return failSensitivities(fmt::format("the impact of {}, which come one after the other nearby,", names));
}

// By the condition's value in the middle of the step that ends with the switch's change.
bool Simulation::Implementation::switchesFaintly(int j) {
  SmoothIntegrator &integrator = integrators_.current();
  const double middle = 0.5 * (integrator.beginTime() + integrator.endTime());
  integrator.interpolate(middle, interpolated_.data());
  at_.setPoint(middle, interpolated_.data());
  at_.switching(ModelEvaluation::Conditions);
  return !switchProgress_.add(j, at_.condition[j]);
}

// The guard is zero at (time_, state_); `stopped` is the first tangential row of a slip of two components that has stopped, else −1.
tf_status Simulation::Implementation::changeMode(const Guard &guard, int stopped, double limit) {
  EventHint hint;
  lastElement_ = elementOf(guard, stopped);
  if (stopped >= 0 && sensitivities_)
    if (const tf_status status = differentiateStop(); status != TF_OK)
      return status;
  const bool isStep = guard.kind == GuardKind::StepLow || guard.kind == GuardKind::StepHigh;
  if (isStep)
    hint = {guard.index, guard.kind == GuardKind::StepHigh ? Switch::One : Switch::Zero};
  if (guard.kind == GuardKind::Force)
    hint.forceless = dynamics_.contactOfMargin(guard.index);
  if (guard.kind == GuardKind::Condition) {
    hint = {guard.index, guard.sign > 0 ? Switch::Zero : Switch::One};
    switchTime_ = time_;
    switchProgress_.changed(guard.index, time_);
    rest_.recordSwitch(guard.index);
  }
  hint.keepsOpen = isStep || guard.kind == GuardKind::Condition;
  std::vector<Transition> &transitions = beginTransitions();
  const bool switches = guard.kind == GuardKind::Condition;
  if (switches)
    beginSwitch();
  if (const tf_status status = settle(transitions, hint); status != TF_OK)
    return status;
  if (const tf_status status = switches ? endSwitch(guard.index) : TF_OK; status != TF_OK)
    return status;
  if (stopped >= 0 && mode_.tangent[stopped] == Tangent::SlipPositive)
    transitions.push_back({TF_EVENT_SLIP_REVERSAL, elementOfTangent(model_, stopped)});
  report(transitions);
  const bool impact = std::any_of(transitions.begin(), transitions.end(), [](const Transition &t) { return t.kind == TF_EVENT_IMPACT; });
  return impact ? afterImpact(limit) : TF_OK;
}

tf_status Simulation::Implementation::afterImpact(double limit) {
  if (sensitivities_)
    sensitivities_->reopenEvent(rate_.data());
  accumulated_ = impulse_;
  accumulated_.push_back(energy_ ? energy_->totals().impactLoss : 0);
  accumulated_.push_back(energy_ ? energy_->totals().frictionLoss : 0);
  const RestPoint *rest = rest_.afterImpact(time_, approaches_, state_.data(), accumulated_, owner_.options.tolerance,
                                            integrators_.current().settings().scale.data(), sensitivities_.get());
  if (sensitivities_)
    sensitivities_->endEvent(rate_.data());
  if (rest != nullptr && rest->time <= std::min(limit, nextSample_))
    return comeToRest(*rest);
  if (SmoothIntegrator *bounces = integrators_.forLowBounces(); bounces != nullptr && rest_.bouncesLow(time_)) {
    if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
      return failEvaluation();
    integrators_.use(*bounces, IntegratorReason::LowBounces);
    startIntegrator(GapsAtStart::Unknown);
  }
  return TF_OK;
}

// A contact that is open in the mode has a gap below zero at (time_, state_).
bool Simulation::Implementation::penetrates(const Mode &mode) {
  at_.setPoint(time_, state_.data());
  at_.switching(ModelEvaluation::Gaps);
  for (int i = 0; i < model_.nc; ++i)
    if (!mode.closed[i] && at_.gap[i] < -selection_.closedGap(i, state_.data()))
      return true;
  return false;
}

// An open contact with an acceleration that is not zero, which opens it, in the mode that begins here. One without any may as well be
// closed, as those of bodies that nothing presses together.
bool Simulation::Implementation::leaves(int contact) {
  constexpr double rounding = 1e-9;
  if (mode_.closed[contact] != 0)
    return false;
  std::fill(contactMask_.begin(), contactMask_.end(), std::uint8_t{0});
  contactMask_[contact] = 1;
  at_.setPoint(time_, state_.data());
  at_.contactTerms(contactMask_.data());
  const GapAcceleration acceleration = at_.gapAcceleration(contact, rate_.data() + model_.nq);
  return std::abs(acceleration.value) > rounding * acceleration.size;
}

// The end of infinitely many impacts: contacts close for good.
tf_status Simulation::Implementation::comeToRest(const RestPoint &point) {
  const double lastImpact = time_;
  rest_.endBounces(point.time, point.contacts);
  afterImpact_ = state_;
  time_ = point.time;
  state_ = point.state;
  Mode &resting = restingMode_;
  resting = mode_;
  for (const int i : point.contacts)
    resting.closed[i] = 1;
  // A contact may stick on the way and open at the point.
  const std::vector<int> owner = contactsOfTangents(model_);
  for (const int j : point.sticking)
    if (owner[j] < 0 || resting.closed[owner[j]])
      resting.tangent[j] = Tangent::Stick;
  projectOnto(resting, time_, state_.data());
  // The point is known to the tolerance: there another contact may be open that the projection closes. Then bounces are followed on.
  if (penetrates(resting)) {
    time_ = lastImpact;
    state_ = afterImpact_;
    if (!dynamics_.start(mode_, time_, state_.data(), rate_.data()))
      return failEvaluation();
    startMode();
    return TF_OK;
  }
  for (int i = 0; i < model_.nc; ++i)
    impulse_[i] += point.accumulated[i];
  if (sensitivities_) {
    const auto project = [&](double time, double *state) { return std::isfinite(projectOnto(resting, time, state)); };
    sensitivities_->setEvent(point.derivatives.data());
    if (!sensitivities_->propagate(project, time_, state_.data()))
      return failSensitivities("infinitely many impacts");
  }
  if (energy_)
    energy_->addImpacts(lastImpact, afterImpact_.data(), time_, state_.data(), point.accumulated[model_.nc],
                        point.accumulated[model_.nc + 1]);
  // The mode on the way need not have forces here any more: settle() finds those that follow.
  dynamics_.start(mode_, time_, state_.data());
  beginEvent();
  std::vector<Transition> &transitions = beginTransitions();
  for (const int i : point.contacts)
    transitions.push_back({TF_EVENT_REST, i});
  if (const tf_status status = settle(transitions); status != TF_OK)
    return status;
  std::erase_if(transitions, [this](const Transition &t) { return t.kind == TF_EVENT_REST && leaves(t.element); });
  report(transitions);
  return TF_OK;
}

// The contact that jams at the zero of a Force guard; −1: none. Where the force is a quotient of two numbers near zero, it is an error's
// work which of them comes first. A mode that begins where another one has just jammed has forces near a pole from its begin on.
int Simulation::Implementation::jamAt(int guard) {
  constexpr double together = 1e-9;
  if (std::isfinite(jamTime_) && time_ - jamTime_ <= together * timeScale())
    return dynamics_.jammedContact();
  return dynamics_.isPole(guard) ? dynamics_.jammedContact(clearlyPressing) : -1;
}

// The force of a contact grows beyond all bounds as D_s reaches zero (Génot and Brogliato, Eur. J. Mech. A/Solids 18, 1999): what follows
// is a frictional impulse that ends the slip.
tf_status Simulation::Implementation::jam(int contact) {
  jamTime_ = time_;
  if (sensitivities_)
    return failSensitivities("a contact force that grows beyond all bounds");
  if (!progress_.add(time_))
    return failWithoutProgress();
  beginEvent();
  std::vector<Transition> &transitions = beginTransitions();
  if (const tf_status status = freeze(transitions, contact); status != TF_OK)
    return status;
  if (const tf_status status = settle(transitions); status != TF_OK)
    return status;
  report(transitions);
  return TF_OK;
}

}  // namespace tf::runtime
