// Frozen phases, and velocities that they leave so small that they end with them.
#include "runtime/simulate/simulation_implementation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

// Of the velocities that these contacts' gap rates and slips are compared with the largest one.
double Simulation::Implementation::velocityScale(const std::vector<int> &contacts) const {
  const double *velocities = state_.data() + model_.nq;
  double scale = 0;
  for (const int i : contacts) {
    const tf_contact &contact = model_.contacts[i];
    scale = std::max(scale, at_.scales.gapRate(i, velocities, 1));
    for (int row = contact.tangent_first; row < contact.tangent_first + contact.tangent_count; ++row)
      scale = std::max(scale, at_.scales.slip(row, velocities, 1));
  }
  return scale;
}

// The fastest approach of these contacts if all of them are so slow that hops after them, with the accelerations of the last evaluation,
// would be lower than the rounding of gaps: no event can tell their order. 0: they are not.
double Simulation::Implementation::fastestUnresolved(const std::vector<int> &approaching) {
  constexpr double rounding = std::numeric_limits<double>::epsilon();
  std::vector<std::uint8_t> &mask = contactMask_;
  std::fill(mask.begin(), mask.end(), std::uint8_t{0});
  for (const int i : approaching)
    mask[i] = 1;
  at_.contactTerms(mask.data());
  double fastest = 0;
  for (const int i : approaching) {
    const double speed = -at_.gapRate[i], acceleration = std::abs(at_.gapAcceleration(i, at_.acceleration.data()).value);
    if (!(speed * speed <= 2 * acceleration * rounding * at_.scales.gap(i, state_.data())))
      return 0;
    fastest = std::max(fastest, speed);
  }
  return fastest;
}

// Without a forced contact the selection's lists of contacts are those at the state.
tf_status Simulation::Implementation::freeze(std::vector<Transition> &transitions, int forced) {
  if (forced >= 0)
    selection_.findTouching(time_, state_.data());
  impact_.setGrazing(selection_.grazing());
  const std::vector<int> &approaching = frozenApproaching_ = selection_.approaching();
  const std::vector<int> &contacts = frozenContacts_ =
      forced >= 0 ? selection_.touching() : impact_.reached(time_, state_.data(), selection_.touching(), approaching);
  // Impacts that the tolerance of velocities does not see have no restitution: where bounces accumulate in a way that cannot be summed
  // (slips of two components that turn with each of them), they end here. Of several contacts with restitution each goes on shaking the
  // others, in cascades within cascades: there the tolerance itself is the limit, as of the error of one step. Impacts whose slips turn are
  // followed numerically, and what they leave of slower ones may be as fast.
  constexpr double followed = 1e-9;
  const bool turns = std::any_of(contacts.begin(), contacts.end(), [this](int i) { return sharesDisk(model_.contacts[i]); });
  const bool shakes =
      contacts.size() > 1 && std::any_of(contacts.begin(), contacts.end(), [this](int i) { return at_.restitution[i] > 0; });
  const double part = shakes  ? std::max(integrators_.current().settings().tolerance, stopTolerance())
                      : turns ? std::max(followed, stopTolerance())
                              : stopTolerance();
  double slow = part * velocityScale(contacts);
  if (shakes)
    slow = std::max(slow, fastestUnresolved(approaching));
  std::vector<int> starters;
  if (forced >= 0) {
    starters.push_back(forced);
    std::copy_if(contacts.begin(), contacts.end(), std::back_inserter(starters),
                 [&](int i) { return i != forced && std::abs(at_.gapRate[i]) <= selection_.stillRate(i, state_.data()); });
  }
  impact_.setElastic(forced >= 0 || std::any_of(approaching.begin(), approaching.end(), [&](int i) { return at_.gapRate[i] < -slow; }));
  closeTogether(contacts);
  if (energy_)
    incoming_ = state_;
  if (sensitivities_) {
    std::vector<double> ignored(model_.nc);
    const auto impact = [&](double time, double *state) { return impact_.apply(time, state, contacts, starters, ignored.data()); };
    if (!sensitivities_->propagate(impact, time_, state_.data()))
      return failSensitivities("the impact");
  }
  if (!impact_.apply(time_, state_.data(), contacts, starters, impulse_.data())) {
    if (impact_.isUnbounded() && forced < 0 && selection_.letGraze(state_.data()))
      return TF_OK;
    return failAt(impact_.text());
  }
  if (impact_.starter() >= 0)
    transitions.push_back({TF_EVENT_PAINLEVE, impact_.starter()});
  ++statistics_.frozen_phases;
  statistics_.breakpoints += impact_.breakpoints();
  const bool slowed = !impact_.isElastic() && (turns || shakes);
  std::fill(mayStop_.begin(), mayStop_.end(), std::uint8_t{1});
  const tf_status stopped = slowed ? stopSlow(contacts, slow) : turns ? TF_OK : stopFaint(contacts);
  if (stopped != TF_OK)
    return stopped;
  if (energy_)
    energy_->addImpact(time_, incoming_.data(), state_.data(), impact_.boundaryWork());
  if (impact_.leavesApproach()) {
    selection_.findTouching(time_, state_.data());
    selection_.letGraze(state_.data());
  }
  for (int i : approaching)
    transitions.push_back({TF_EVENT_IMPACT, i});
  return TF_OK;
}

// The mode before, with the step variables of now: of a run that starts there is none yet.
void Simulation::Implementation::copyMode(Mode &mode) const {
  mode = mode_;
  mode.switches.resize(model_.ns, Switch::Zero);
  for (int j = 0; j < model_.ns; ++j)
    if (mode.switches[j] != Switch::Sliding)
      mode.switches[j] = at_.stepVariable[j] == 1 ? Switch::One : Switch::Zero;
}

// Onto what a mode holds at zero, whether or not it has admissible forces: settle() decides whether the contacts stay closed. False: the
// rows cannot be evaluated.
bool Simulation::Implementation::projectOnto(const Mode &mode, double time, double *state) {
  constexpr int mostPasses = 3;
  constexpr double rounding = 1e-14;
  const double *scale = integrators_.current().settings().scale.data();
  double correction = 1;
  for (int pass = 0; pass < mostPasses && correction > rounding; ++pass) {
    if (pass > 0 && dynamics_.heldResidual(time, state) <= rounding)
      break;
    if (!dynamics_.hold(mode, time, state))
      return false;
    correction = dynamics_.project(time, state, scale);
  }
  return true;
}

// Contacts touch within the accuracy of events only. Corners of one face then are not quite in one plane, and their slips, which one motion
// should bring to zero together, differ by the tilt of that plane times the speed of approach: the gaps of all that approach or rest become
// zero. The change of position is as small, or larger by what it takes to turn corners that are near one another into one plane.
void Simulation::Implementation::closeTogether(const std::vector<int> &contacts) {
  constexpr double farthest = 1e-7;
  if (std::none_of(contacts.begin(), contacts.end(), [this](int i) { return sharesDisk(model_.contacts[i]); }))
    return;
  Mode touching;
  copyMode(touching);
  std::fill(touching.closed.begin(), touching.closed.end(), std::uint8_t{0});
  std::fill(touching.tangent.begin(), touching.tangent.end(), Tangent::None);
  at_.setPoint(time_, state_.data());
  at_.switching(ModelEvaluation::Gaps);
  for (const int i : contacts)
    touching.closed[i] = at_.gapRate[i] <= selection_.stillRate(i, state_.data()) ? 1 : 0;
  std::vector<double> moved = state_;
  if (!projectOnto(touching, time_, moved.data()))
    return;
  const double *scale = integrators_.current().settings().scale.data();
  for (int k = 0; k < model_.nq; ++k)
    if (!(std::abs(moved[k] - state_[k]) <= farthest * scale[k]))
      return;
  std::copy_n(moved.begin(), model_.nq, state_.begin());
}

// An impact of one of many contacts shakes the others, and these shake one another in hops that last an instant and are lower than any
// rounding error. Where an impact leaves velocities of touching contacts so far below the tolerance, they end at once. Slips that were
// there before are no such shaking but a motion, however slow: an impact that stopped it would have it start again, from other forces,
// which may open the contact for the next impact. At the call slips are those before the impact.
tf_status Simulation::Implementation::stopFaint(const std::vector<int> &contacts) {
  constexpr double faint = 1e-3;
  if (contacts.size() < 2)
    return TF_OK;
  const double *state = state_.data();
  const double slow = faint * integrators_.current().settings().tolerance * velocityScale(contacts);
  for (int row = 0; row < model_.nt; ++row)
    mayStop_[row] = std::abs(at_.slip[row]) <= selection_.stillSlip(row, state) ? 1 : 0;
  at_.setPoint(time_, state_.data());
  at_.switching(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  const auto stops = [&](int i) {
    const tf_contact &contact = model_.contacts[i];
    const double rate = std::abs(at_.gapRate[i]);
    if (rate > selection_.stillRate(i, state))
      return rate <= slow;
    bool any = false;
    for (int row = contact.tangent_first; row < contact.tangent_first + contact.tangent_count; ++row)
      any = any || (mayStop_[row] != 0 && std::abs(at_.slip[row]) > selection_.stillSlip(row, state) && std::abs(at_.slip[row]) <= slow);
    return any;
  };
  return std::any_of(contacts.begin(), contacts.end(), stops) ? stopSlow(contacts, slow) : TF_OK;
}

// Whether the velocities of these touching contacts, once what is as slow has stopped, are what they should be: zero where a contact is
// held, not negative, and changed by hardly more than what was stopped. Of redundant contacts some may have to open: where they cannot stop
// together, one of them would be pressed in or thrown up; and where they are wedged, what slides fast along the wedge would have to stop.
bool Simulation::Implementation::acceptsStop(const std::vector<int> &contacts, const Mode &resting, const std::vector<double> &gapRates,
                                             const std::vector<double> &slips, double slow) {
  const double largestChange = 10 * slow;
  return std::all_of(contacts.begin(), contacts.end(), [&](int i) {
    const tf_contact &contact = model_.contacts[i];
    const double rate = at_.gapRate[i], still = selection_.stillRate(i, state_.data());
    bool accepts = rate >= -still && (!resting.closed[i] || rate <= still) && std::abs(rate - gapRates[i]) <= largestChange;
    for (int row = contact.tangent_first; row < contact.tangent_first + contact.tangent_count; ++row)
      accepts = accepts && std::abs(at_.slip[row] - slips[row]) <= largestChange;
    return accepts;
  });
}

// Gap rates and slips (in mayStop_) of these contacts that are not faster become zero, if they can together. After impacts that
// the tolerance does not see those of two components do: they have no direction there that is more than an error, and would start one
// another again and again.
tf_status Simulation::Implementation::stopSlow(const std::vector<int> &contacts, double slow) {
  Mode &resting = restingMode_;
  copyMode(resting);
  at_.setPoint(time_, state_.data());
  at_.switching(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  for (const int i : contacts) {
    const tf_contact &contact = model_.contacts[i];
    resting.closed[i] = std::abs(at_.gapRate[i]) <= slow ? 1 : 0;
    const bool pair = sharesDisk(contact);
    for (int k = 0; k < (pair ? 2 : contact.tangent_count); ++k) {
      const int row = contact.tangent_first + k;
      const double least = mayStop_[row] ? slow : selection_.stillSlip(row, state_.data());
      const double speed =
          pair ? std::hypot(at_.slip[contact.tangent_first], at_.slip[contact.tangent_first + 1]) : std::abs(at_.slip[row]);
      resting.tangent[row] = !resting.closed[i]          ? Tangent::None
                             : speed <= least            ? Tangent::Stick
                             : pair || at_.slip[row] > 0 ? Tangent::SlipPositive
                                                         : Tangent::SlipNegative;
    }
  }
  const auto stop = [&](double time, double *state) { return projectOnto(resting, time, state); };
  std::vector<double> stopped = state_;
  const std::vector<double> gapRates = at_.gapRate, slips = at_.slip;
  if (!stop(time_, stopped.data()))
    return TF_OK;
  at_.setPoint(time_, stopped.data());
  at_.switching(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  if (!acceptsStop(contacts, resting, gapRates, slips, slow))
    return TF_OK;
  if (sensitivities_ && !sensitivities_->propagate(stop, time_, state_.data()))
    return failSensitivities("the impact");
  state_ = std::move(stopped);
  return TF_OK;
}

}  // namespace tf::runtime
