// The ends of an integrator's steps: projection, constraints, and what ends a run inside a step.
#include "runtime/simulate/simulation_implementation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

// Energy and sensitivities over a part of the integrator's step, from `begin`, which becomes its end. False: they cannot be differentiated.
bool Simulation::Implementation::passStep(double &begin, double end) {
  SmoothIntegrator &integrator = integrators_.current();
  if (energy_)
    energy_->addStep(integrator, begin, end);
  const double turned = std::clamp(stopping_.begin, begin, end);
  const bool differentiated = !sensitivities_ || (sensitivities_->addStep(integrator, begin, turned) &&
                                                  sensitivities_->addStep(integrator, turned, end, stopping_.held));
  begin = end;
  return differentiated;
}

// All of the integrator's step, with the samples inside it. False: see passStep.
bool Simulation::Implementation::passSamples() {
  SmoothIntegrator &integrator = integrators_.current();
  double passed = integrator.beginTime();
  while (nextSample_ < integrator.endTime()) {
    if (!passStep(passed, nextSample_))
      return false;
    giveSample(nextSample_);
  }
  return passStep(passed, integrator.endTime());
}

// On the interpolant, projected onto what the mode holds at zero.
void Simulation::Implementation::giveSample(double time) {
  SmoothIntegrator &integrator = integrators_.current();
  sample_.resize(n_);
  sampleRate_.resize(n_);
  integrator.interpolate(time, sample_.data());
  if (dynamics_.needsProjection() && dynamics_.evaluate(time, sample_.data(), sampleRate_.data()))
    dynamics_.project(time, sample_.data(), integrator.settings().scale.data());
  // Also where the callback throws.
  struct Exchanged {
    Implementation &simulation;
    double time;
    explicit Exchanged(Implementation &own, double sample) : simulation(own), time(sample) { exchange(); }
    ~Exchanged() { exchange(); }
    void exchange() {
      std::swap(time, simulation.time_);
      simulation.state_.swap(simulation.sample_);
      simulation.isInSample_ = !simulation.isInSample_;
    }
  } const atSample(*this, time);
  nextSample_ = owner_.onSample(time);
}

// The end of the integrator's step onto what the mode holds at zero. A correction by the rows of the last evaluation leaves its product
// with the way from there, so that large ones take several. After one that is not negligible the dynamics is evaluated at the end.
tf_status Simulation::Implementation::projectEnd() {
  constexpr int mostPasses = 8;
  constexpr double rounding = 1e-14, tolerances = 100, visible = 1e-9;
  leapsHeld_ = false;
  if (!dynamics_.needsProjection())
    return TF_OK;
  SmoothIntegrator &integrator = integrators_.current();
  // At rest on what does not move: the begin of a step has been projected.
  if (model_.variation == nullptr && std::equal(integrator.begin(), integrator.begin() + model_.nq + model_.nv, integrator.end()))
    return TF_OK;
  double way = 0, left = 1;
  for (int pass = 0; pass < mostPasses && left > rounding; ++pass) {
    const double before = integrator.correction();
    const double correction = dynamics_.project(integrator.endTime(), integrator.end(), integrator.settings().scale.data());
    if (const double first = std::max(before, correction); pass == 0 && isSuspicious(first)) {
      if (const tf_status status = checkJump(); status != TF_OK)
        return status;
      leapsHeld_ = first > std::max(tolerances * integrator.settings().tolerance, visible);
    }
    way += correction;
    left = correction * way;
    if (correction > integrator.negligibleCorrection()) {
      if (!dynamics_.evaluate(integrator.endTime(), integrator.end(), integrator.endRate()))
        return failEvaluation();
      way = 0;
    }
  }
  return TF_OK;
}

// Of a step in which what the mode holds moves far without a jump: a rise of the ground, say, that is over before it ends. A part of it in
// which nothing of that is to be seen.
tf_status Simulation::Implementation::endBeforeLeap(double limit) {
  constexpr double part = 0.25, shortest = 1e-10;
  SmoothIntegrator &integrator = integrators_.current();
  const double least = shortest * std::max(timeScale(), std::abs(integrator.beginTime()));
  bool isShorter = true;
  for (double length = part * (integrator.endTime() - integrator.beginTime()); (leapsHeld_ || !isShorter) && length > least;
       length *= part) {
    isShorter = integrator.shorten(integrator.beginTime() + length);
    if (const tf_status projected = isShorter ? projectEnd() : TF_OK; projected != TF_OK)
      return projected;
  }
  if (!isShorter)
    return failStep(StepStatus::TooSmall);
  DetectedEvent event;
  if (const tf_status searched = searchStep(event); searched != TF_OK)
    return searched;
  if (const tf_status shortened = shortenToDefined(event); shortened != TF_OK)
    return shortened;
  return event.guard >= 0 ? handle(event, limit) : endStep(integrator.endTime() - integrator.beginTime(), limit);
}

// A correction of the step's end that is far larger than its error, or a large part of the step.
bool Simulation::Implementation::isSuspicious(double correction) {
  const SmoothIntegrator &integrator = integrators_.current();
  const double tolerance = integrator.settings().tolerance;
  if (!(correction > tolerance))
    return false;
  double motion = 0;
  for (int k = 0; k < model_.nq; ++k)
    motion = std::max(motion, std::abs(integrator.beginRate()[k]) / integrator.settings().scale[k]);
  return correction > std::min(100 * tolerance, 0.01) || correction > 0.1 * motion * (integrator.endTime() - integrator.beginTime());
}

// Does a gap, slip or constraint that the mode holds, or a derivative of it, jump inside the step, and a little beyond its ends? Then it
// does, or its rate, along the first orders of the motion, and the run ends there: the rows of the mode are those of one side.
tf_status Simulation::Implementation::checkJump() {
  if (const tf_status status = checkJumpOf(largestHeldRate, "the derivative of {} jumps at t = {:.10g}"); status != TF_OK)
    return status;
  return checkJumpOf(largestHeldValue, "{} jumps at t = {:.10g}");
}

tf_status Simulation::Implementation::checkJumpOf(HeldRow (*largestHeld)(ModelEvaluation &, const Mode &, double, const double *),
                                                  const char *text) {
  constexpr double resolution = 8 * std::numeric_limits<double>::epsilon(), beyond = 0.25, nearby = 1e-10, rounding = 1e-9;
  SmoothIntegrator &integrator = integrators_.current();
  const double begin = integrator.beginTime();
  const bool hasVelocities = model_.kinematics == nullptr;
  interpolated_.assign(integrator.begin(), integrator.begin() + n_);
  const auto heldAt = [&](double time) {
    const double passed = time - begin, *rate = integrator.beginRate();
    for (int k = 0; k < model_.nq; ++k)
      interpolated_[k] = integrator.begin()[k] + passed * (rate[k] + (hasVelocities ? 0.5 * passed * rate[model_.nq + k] : 0));
    return largestHeld(at_, mode_, time, interpolated_.data());
  };
  const double reach = std::max(beyond * (integrator.endTime() - begin), nearby * std::abs(begin));
  double low = begin - reach, high = integrator.endTime() + reach, before = heldAt(low).size;
  HeldRow after = heldAt(high);
  const double middle = 0.5 * (before + after.size);
  while (high - low > resolution * std::max(std::abs(high), high - begin)) {
    const double time = 0.5 * (low + high);
    const HeldRow held = heldAt(time);
    (held.size > middle ? high : low) = time;
    if (held.size > middle)
      after = held;
    else
      before = held.size;
  }
  at_.setPoint(integrator.endTime(), integrator.end());
  if (after.size - before > std::max(0.5 * after.size, rounding * after.scale))
    return fail(fmt::format(fmt::runtime(text), nameOf(model_, after), low));
  return TF_OK;
}

// The component of the rate that jumps inside the integrator's step, −1: none. What `noEvent` and `smooth` hide is no event; its time moves
// with the motion all the same. Where friction turns with a slip that starts, it seems to jump. Steps are so short where they meet a jump
// that it changes the motion over them by about the tolerance; what changes it by far less, or by rounding, is the rounding of the rate.
int Simulation::Implementation::jumpingRate() {
  constexpr double visible = 1e-6, mixed = 1e-3, lopsided = 0.3, remaining = 0.5, alike = 0.2,
                   resolution = 8 * std::numeric_limits<double>::epsilon();
  SmoothIntegrator &integrator = integrators_.current();
  if (dynamics_.hasTurningSlips())
    return -1;
  const double least = std::max(1e-4 * owner_.options.tolerance, 64 * std::numeric_limits<double>::epsilon()),
               length = integrator.endTime() - integrator.beginTime();
  double low = integrator.beginTime(), high = integrator.endTime();
  std::vector<double> first(integrator.beginRate(), integrator.beginRate() + n_), last(integrator.endRate(), integrator.endRate() + n_),
      inside(first.size());
  const auto readInside = [&](double time) {
    integrator.interpolate(time, interpolated_.data());
    return dynamics_.evaluate(time, interpolated_.data(), inside.data());
  };
  if (!readInside(0.5 * (low + high)))
    return -1;
  // What contacts hold is a difference of large terms, and has the rounding errors of others through M.
  std::vector<double> terms = last;
  dynamics_.accelerationTerms(terms.data() + model_.nq);
  const double *scale = integrator.settings().scale.data();
  double largest = 0;
  for (int i = model_.nq; i < at_.tauIndex(); ++i)
    largest = std::max(largest, terms[i] = std::max({std::abs(terms[i]), std::abs(first[i]), std::abs(last[i])}) / scale[i]);
  int found = -1;
  double most = visible;
  for (int i = model_.nq; i < at_.tauIndex(); ++i) {
    const double change = std::abs(last[i] - first[i]), size = std::max(terms[i], mixed * largest) * scale[i];
    if (change > most * size && change * length > least * scale[i] &&
        std::abs(inside[i] - 0.5 * (first[i] + last[i])) > lopsided * change) {
      most = change / size;
      found = i;
    }
  }
  if (found < 0)
    return -1;
  const double whole = std::abs(last[found] - first[found]);
  while (high - low > resolution * std::max(std::abs(high), high - low)) {
    const double time = 0.5 * (low + high);
    if (!(time > low && time < high) || !readInside(time))
      break;
    const bool isEarlier = std::abs(inside[found] - first[found]) > std::abs(last[found] - inside[found]);
    (isEarlier ? high : low) = time;
    (isEarlier ? last : first)[found] = inside[found];
    if (std::abs(last[found] - first[found]) < remaining * whole)
      return -1;
  }
  // Rounding errors of large terms may be as large, but on both sides alike.
  for (const double part : {1e-4, 1e-3, 3e-3, 1e-2})
    for (const bool isEarlier : {true, false}) {
      const double distance = part * (integrator.endTime() - integrator.beginTime()), time = isEarlier ? low - distance : high + distance;
      if (time > integrator.beginTime() && time < integrator.endTime() &&
          !(readInside(time) && std::abs(inside[found] - (isEarlier ? first : last)[found]) < alike * whole))
        return -1;
    }
  return found;
}

// Constraints that follow from others for the first time, at the evaluation's point, which is (time_, state_).
void Simulation::Implementation::noteRedundancy() {
  if (!redundancy_.isPresent())
    return;
  for (const std::string &text : redundancy_.newlyRedundant())
    note(TF_NOTE_REDUNDANT, time_, text);
  statistics_.redundant_constraints = redundancy_.most();
}

// At the start and where rows may have become other ones, after the choice of the mode.
tf_status Simulation::Implementation::startConstraints() {
  redundancy_.choose(state_.data());
  noteRedundancy();
  const std::string text = redundancy_.contradiction(owner_.options.tolerance);
  return text.empty() ? TF_OK : failAt(text);
}

// Where constraints follow from others: which of them count from the end of the integrator's step on, and whether all are satisfied there.
tf_status Simulation::Implementation::chooseConstraints() {
  constexpr double undecided = 100;  // tolerances
  SmoothIntegrator &integrator = integrators_.current();
  const double time = integrator.endTime();
  if (!dynamics_.evaluate(time, integrator.end(), rate_.data()))
    return TF_OK;
  const int rank = at_.mobility.rank();
  if (redundancy_.choose(integrator.end())) {
    // Rows that have been left out, as they followed from others for a while, have not been held.
    if (at_.mobility.rank() > rank &&
        dynamics_.project(time, integrator.end(), integrator.settings().scale.data()) > undecided * owner_.options.tolerance)
      return failAt(redundancy_.undecided(owner_.options.tolerance));
    if (!dynamics_.evaluate(time, integrator.end(), integrator.endRate()))
      return failEvaluation();
  }
  const std::string text = redundancy_.contradiction(owner_.options.tolerance);
  return text.empty() ? TF_OK : fail(fmt::format("{} at t = {:.10g}", text, time));
}

// At the end of the integrator's step, before its samples are taken: no contradictions, no singular position.
tf_status Simulation::Implementation::checkConstraints() {
  if (model_.nh == 0)
    return TF_OK;
  if (redundancy_.isExpected())
    if (const tf_status status = chooseConstraints(); status != TF_OK)
      return status;
  const std::string text = redundancy_.singularity(owner_.options.tolerance);
  return text.empty() ? TF_OK : failAt(text);
}

// Where a coefficient of friction falls below zero inside the integrator's step, the run ends there.
tf_status Simulation::Implementation::checkFriction() {
  constexpr int samples = 16, bisections = 50;
  dynamics_.forgetNegativeFriction();
  SmoothIntegrator &integrator = integrators_.current();
  const double begin = integrator.beginTime(), length = integrator.endTime() - begin;
  const auto negativeAt = [&](double time) {
    integrator.interpolate(time, interpolated_.data());
    at_.setPoint(time, interpolated_.data());
    return failures_.negativeFriction(&mode_);
  };
  int found = 1;
  while (found <= samples && negativeAt(begin + length * found / samples).empty())
    ++found;
  if (found > samples)
    return dynamics_.evaluate(integrator.endTime(), integrator.end(), integrator.endRate()) ? TF_OK : failEvaluation();
  double low = begin + length * (found - 1) / samples, high = begin + length * found / samples;
  for (int k = 0; k < bisections; ++k)
    (negativeAt(0.5 * (low + high)).empty() ? low : high) = 0.5 * (low + high);
  const std::string text = negativeAt(high);
  if (integrator.shorten(high)) {
    passSamples();
    time_ = high;
    std::copy_n(integrator.end(), n_, state_.begin());
  }
  return failAt(text);
}

}  // namespace tf::runtime
