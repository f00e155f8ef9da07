// Slips of two components: where they stop, and steps that end because their direction turns.
#include "runtime/simulate/simulation_implementation.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Slips of two components that are not faster than this, times what is taken for zero, are about to stop.
constexpr double aboutToStop = 1e3;
// Of a step that ends in a stop: there is no direction at the stop itself, but so long before.
constexpr double partBeforeStop = 0.02;

}  // namespace

// Slips and gap rates below this part of their scale may be taken for zero: far within the tolerance of velocities.
double Simulation::Implementation::stopTolerance() {
  return std::max(0.05 * integrators_.current().settings().tolerance, 10 * selection_.tolerances().velocity);
}

// Inside the integrator's step; the state there is in interpolated_.
double Simulation::Implementation::slipSpeedInside(int guard, double time) {
  integrators_.current().interpolate(time, interpolated_.data());
  at_.setPoint(time, interpolated_.data());
  at_.switching(ModelEvaluation::Slips);
  return dynamics_.slipSpeed(guard);
}

// The slip of two components whose part along the reference direction falls to zero at the event: is it zero altogether there, far within
// the tolerance? Else it turns by a right angle. Where it hardly turns any more its direction is held, since the right-hand side is
// singular at zero; friction that has the direction of the step's begin leaves a rest of the size of the turn, which is bounded here too.
bool Simulation::Implementation::locateStop(DetectedEvent &event) {
  SmoothIntegrator &integrator = integrators_.current();
  const double part = stopTolerance(), allowed = part * dynamics_.slipScale(event.guard);
  const double most = 10 * allowed, slow = aboutToStop * allowed, turned = turnsBefore(event);
  const double speed = slipSpeedInside(event.guard, event.time);
  if (speed > slow || turned > most)
    return false;
  const DetectedEvent detected = event;
  aimDirections(event, aboutToStop * part);
  // Slips of one body end together: none of them has a direction there.
  slipSpeedInside(event.guard, event.time);
  dynamics_.holdDirections(aboutToStop * part);
  if (detection_.locate(event) == EventDetection::Location::Found) {
    at_.setPoint(integrator.endTime(), integrator.end());
    at_.switching(ModelEvaluation::Slips);
    if (dynamics_.slipSpeed(event.guard) <= most)
      return true;
  }
  dynamics_.holdDirections(0);
  event = detected;
  if (speed > most)
    return false;
  // A step that begins with a faster slip passes the place where its direction is singular, and is less exact there than elsewhere.
  at_.setPoint(integrator.beginTime(), integrator.begin());
  at_.switching(ModelEvaluation::Slips);
  if (dynamics_.slipSpeed(event.guard) > slow)
    return false;
  // Other slips that have just begun may keep implicit equations from being solved: the interpolant is as good as the step.
  integrator.interpolate(event.time, interpolated_.data());
  std::copy_n(interpolated_.begin(), n_, integrator.end());
  integrator.moveEnd(event.time);
  return dynamics_.evaluate(event.time, integrator.end(), integrator.endRate());
}

// The guard of a slip of one component that has fallen to zero at the end of the integrator's step; −1: none.
int Simulation::Implementation::slipThatStops() {
  SmoothIntegrator &integrator = integrators_.current();
  const double time = integrator.endTime();
  at_.setPoint(time, integrator.end());
  at_.switching(ModelEvaluation::Slips);
  for (int guard = 0; guard < static_cast<int>(dynamics_.guards().size()); ++guard)
    if (const Guard &g = dynamics_.guards()[guard];
        g.kind == GuardKind::Slip && std::abs(at_.slip[g.index]) <= selection_.stillSlip(g.index, integrator.end()) &&
        dynamics_.evaluate(time, integrator.end(), interpolated_.data()) && dynamics_.slipRate(guard) < 0)
      return guard;
  return -1;
}

// How much less friction along the slip takes from it until the event where it has the direction of the step's begin: of the slip there as
// much as the cosine of the angle by which it turns lacks. Of a slip that can only move along a curve no other rest shows that.
double Simulation::Implementation::turnsBefore(const DetectedEvent &event) {
  SmoothIntegrator &integrator = integrators_.current();
  const double begin = integrator.beginTime(), time = event.time - partBeforeStop * (event.time - begin);
  if (!(time > begin && time < event.time))
    return 0;
  const double speed = slipSpeedInside(event.guard, time), along = dynamics_.guardValue(event.guard);
  at_.setPoint(begin, integrator.begin());
  at_.switching(ModelEvaluation::Slips);
  return speed > 0 ? dynamics_.slipSpeed(event.guard) * (speed - along) / speed : 0;
}

// Directions that are held where a slip stops at the event are those that it comes there with. Those of explicit stages would be made of
// their errors where the slip is slow: they have the mean of the step's.
void Simulation::Implementation::aimDirections(const DetectedEvent &event, double part) {
  const SmoothIntegrator &integrator = integrators_.current();
  const double length = event.time - integrator.beginTime();
  const auto count = static_cast<std::size_t>(dynamics_.turningPairCount());
  slopes_.assign(4 * count, 0.0);
  double *earlier = slopes_.data(), *later = earlier + count, *held = later + count, *inside = held + count;
  const auto readSlopes = [&](double before, double *slopes) {
    slipSpeedInside(event.guard, event.time - before * length);
    dynamics_.slopesOfSlips(slopes);
  };
  readSlopes(2 * partBeforeStop, earlier);
  readSlopes(partBeforeStop, later);
  if (integrator.hasExactStages()) {
    for (std::size_t k = 0; k < count; ++k)
      held[k] = 2 * later[k] - earlier[k];
    return dynamics_.aimDirections(earlier, later, held, part);
  }
  // Gauss' quadrature of order 6.
  constexpr double nodes[] = {0.1127016653792583, 0.5, 0.8872983346207417}, weights[] = {5.0 / 18, 4.0 / 9, 5.0 / 18};
  for (int node = 0; node < 3; ++node) {
    readSlopes(nodes[node], inside);
    for (std::size_t k = 0; k < count; ++k)
      held[k] += weights[node] * inside[k];
  }
  dynamics_.aimDirections(earlier, later, held, 0);
}

// The error of a velocity over a run may be this part of its scale.
double Simulation::Implementation::lingeringSpeed() { return 10 * integrators_.current().settings().tolerance; }

// Friction turns within a time of the order of the slip that is left: right before a stop derivatives of its direction are made of errors.
// In that last part of the step it keeps the direction in which the slip has come there, and differentiateStop does the rest.
void Simulation::Implementation::findStopping(int guard) {
  constexpr double least = 1e-7, margin = 2;
  constexpr int bisections = 40;
  SmoothIntegrator &integrator = integrators_.current();
  const double part = std::max(least, aboutToStop * stopTolerance()), left = part * dynamics_.slipScale(guard);
  double early = integrator.beginTime(), late = integrator.endTime();
  if (slipSpeedInside(guard, early) <= left)
    late = early;
  for (int k = 0; k < bisections && late > early; ++k)
    (slipSpeedInside(guard, 0.5 * (early + late)) > left ? early : late) = 0.5 * (early + late);
  integrator.interpolate(late, interpolated_.data());
  dynamics_.turnToSlips(late, interpolated_.data());
  stopping_ = {late, margin * part};
}

// Slips of two components that have stopped at (time_, state_) stop nearby within an instant of the order of the difference, whose impulses
// are those of friction on them and of what else the mode holds: contacts that open with the stop do so behind it.
tf_status Simulation::Implementation::differentiateStop() {
  Mode &stopping = restingMode_;
  stopping = mode_;
  const std::vector<int> pair = pairsOfTangents(model_);
  at_.setPoint(time_, state_.data());
  at_.switchingOfAll(ModelEvaluation::Slips);
  const auto isStill = [this](int row) { return std::abs(at_.slip[row]) <= selection_.stillSlip(row, state_.data()); };
  for (int row = 0; row < model_.nt; ++row)
    if (stopping.tangent[row] == Tangent::SlipPositive && pair[row] >= 0 && isStill(row) && isStill(pair[row]))
      stopping.tangent[row] = Tangent::Stick;
  const double *scale = integrators_.current().settings().scale.data();
  const bool hasForces = dynamics_.start(stopping, time_, state_.data());
  const auto stop = [&](double time, double *state) {
    return hasForces ? dynamics_.stop(time, state, scale) : projectOnto(stopping, time, state);
  };
  if (!sensitivities_->propagate(stop, time_, state_.data()))
    return failSensitivities("the end of a slip");
  hasStopMoved_ = sensitivities_->hasMoved();
  return TF_OK;
}

// The guard of a slip of two components that is not faster than the errors that the tolerance allows, but faster than `least` parts of its
// scale; −1: none. The direction of one so slow is no more than an error.
int Simulation::Implementation::slowSlip(double least) {
  const double part = lingeringSpeed();
  const std::vector<Guard> &guards = dynamics_.guards();
  for (int k = 0; k < static_cast<int>(guards.size()); ++k) {
    if (guards[k].kind != GuardKind::SlipAlong)
      continue;
    const double speed = dynamics_.slipSpeed(k), scale = dynamics_.slipScale(k);
    if (speed <= part * scale && speed >= least * scale)
      return k;
  }
  return -1;
}

// One that has been so for many steps: those of implicit methods have solutions in which it neither stops nor starts.
int Simulation::Implementation::lingeringSlip() {
  constexpr int most = 200;
  if (!dynamics_.hasTurningSlips())
    return -1;
  const int found = slowSlip(0);
  lingeringSteps_ = found >= 0 ? lingeringSteps_ + 1 : 0;
  return lingeringSteps_ > most ? found : -1;
}

// One where events follow each other at once: friction that has the direction of errors ends modes again and again. A slip that is zero
// has just begun.
int Simulation::Implementation::chatteringSlip() {
  constexpr int most = 50;
  if (progress_.count <= most + progress_.elements || !dynamics_.hasTurningSlips())
    return -1;
  at_.setPoint(time_, state_.data());
  at_.switching(ModelEvaluation::Slips);
  return slowSlip(10 * selection_.tolerances().velocity);
}

// It becomes zero: what follows is a stick, or a slip that starts from zero.
tf_status Simulation::Implementation::stopLingering(int guard, double limit) {
  lingeringSteps_ = 0;
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return failEvaluation();
  dynamics_.projectStop(time_, state_.data(), integrators_.current().settings().scale.data(), guard, lingeringSpeed());
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return failEvaluation();
  return endMode(guard, dynamics_.slipRow(guard), limit);
}

// The step ends where the slip has turned by no more than 60°, or on most of the way to zero; the next one has another reference direction.
tf_status Simulation::Implementation::followTurn(const DetectedEvent &event, double limit) {
  SmoothIntegrator &integrator = integrators_.current();
  const double begin = integrator.beginTime();
  double length = event.time - begin;
  for (bool good = false; !good;) {
    length *= 0.75;
    if (begin + length <= begin)
      return failEvaluation();
    if (!integrator.shorten(begin + length))
      continue;
    at_.switching(ModelEvaluation::Slips);
    good = dynamics_.guardValue(event.guard) >= 0.5 * dynamics_.slipSpeed(event.guard) && integrator.isResolved();
  }
  return endStep(0.5 * length, limit);
}

// Slips of two components that have just begun, or are about to end, may keep the equations of a step to the event from being solved: those
// of a shorter one can be, and the next step has other directions to start from. So does what a step has passed unseen.
tf_status Simulation::Implementation::approach(const DetectedEvent &event, double limit) {
  SmoothIntegrator &integrator = integrators_.current();
  const double begin = integrator.beginTime();
  double length = event.time - begin;
  do {
    length *= 0.5;
    if (begin + length <= begin)
      return chooseAnew(event.guard, limit);
  } while (!integrator.shorten(begin + length) || !integrator.isResolved());
  return endStep(0.5 * length, limit);
}

// No step from (time_, state_) leads towards the guard's event. What jams there gets its impulse; else the contacts are selected again, as
// at the event itself.
tf_status Simulation::Implementation::chooseAnew(int guard, double limit) {
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()) || dynamics_.guards()[guard].kind == GuardKind::SlipAlong)
    return failEvaluation();
  if (const int contact = dynamics_.jammedContact(); contact >= 0)
    return jam(contact);
  return endMode(guard, -1, limit);
}

// The step that has been shortened ends without an event; `next` is a first guess of the length of the next one. Where slips turn the
// shorter step may be quite another one, in which a force has become negative, say; beyond a pole that would be no zero of it.
tf_status Simulation::Implementation::endStep(double next, double limit) {
  if (const tf_status status = projectEnd(); status != TF_OK)
    return status;
  DetectedEvent event;
  event.time = integrators_.current().endTime();
  if ((!dynamics_.mayTurnBeyondPole() || dynamics_.isClearOfPole()) && detection_.findEarlier(event))
    return handle(event, limit);
  if (const tf_status status = commit(); status != TF_OK)
    return status;
  suggestedStep_ = next;
  return resumeTurned(limit);
}

// The step ends where a force is to be zero, and it is not: where slips are slow, steps that hardly differ in length may end with other
// directions of friction, and their forces jump. Shorter steps follow the turn.
bool Simulation::Implementation::jumpsAt(const DetectedEvent &event) {
  constexpr double shortest = 1e-12;  // of the time scale
  const SmoothIntegrator &integrator = integrators_.current();
  return dynamics_.hasTurningSlips() && detection_.missesZero(event) && !dynamics_.isPole(event.guard) &&
         integrator.endTime() - integrator.beginTime() > shortest * timeScale();
}

// The mode goes on from (time_, state_) with the directions that slips have there. That may turn the friction of slow ones at once: a force
// that the mode does not admit any more then ends it.
tf_status Simulation::Implementation::resumeTurned(double limit) {
  const bool jumps = dynamics_.renewDirections(time_, state_.data());
  if (!dynamics_.evaluate(time_, state_.data(), rate_.data()))
    return failEvaluation();
  if (const int broken = jumps ? detection_.brokenForce() : -1; broken >= 0)
    return endMode(broken, -1, limit);
  resumeMode();
  return TF_OK;
}

// The mode ends at (time_, state_), where the dynamics has been evaluated, by this guard; `stopped` as in changeMode.
tf_status Simulation::Implementation::endMode(int guard, int stopped, double limit) {
  if (!progress_.add(time_))
    return failWithoutProgress();
  beginEvent();
  if (const tf_status status = differentiateEvent(guard); status != TF_OK)
    return status;
  const Guard ended = dynamics_.guards()[guard];
  return changeMode(ended, stopped, limit);
}

}  // namespace tf::runtime
