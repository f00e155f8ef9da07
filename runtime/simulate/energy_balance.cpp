#include "runtime/simulate/energy_balance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// Gauss–Legendre quadrature on [0, 1] with four points, order 8, and with two, order 4.
constexpr std::array<double, 4> legendreNodes = {0.069431844202973712, 0.330009478207571868, 0.669990521792428132, 0.930568155797026288};
constexpr std::array<double, 4> legendreWeights = {0.173927422568726929, 0.326072577431273071, 0.326072577431273071, 0.173927422568726929};
constexpr std::array<double, 2> shortNodes = {0.211324865405187118, 0.788675134594812882};
constexpr std::array<double, 2> shortWeights = {0.5, 0.5};

}  // namespace

EnergyBalance::Energy EnergyBalance::energyAt(double time, const double *state) {
  Energy energy;
  dynamics_.model().setPoint(time, state);
  dynamics_.model().energies(energy.kinetic, energy.potential, energy.power);
  return energy;
}

void EnergyBalance::note(const Energy &energy) {
  totals_.largest = std::max({totals_.largest, energy.kinetic, std::abs(energy.potential)});
}

void EnergyBalance::start(double time, const double *state) {
  totals_ = {};
  const Energy energy = energyAt(time, state);
  totals_.start = energy.mechanical();
  note(energy);
}

// ∂V/∂u u', by a five-point difference along u', at the point of the evaluation.
double EnergyBalance::inputPower(double potential) {
  constexpr double part = 1e-3;  // of the inputs
  ModelEvaluation &at = dynamics_.model();
  double fastest = 0;  // relative to the inputs
  for (std::size_t k = 0; k < at.input.size(); ++k)
    fastest = std::max(fastest, std::abs(at.inputRate[k]) / std::max(1.0, std::abs(at.input[k])));
  if (fastest == 0)
    return 0;
  const double h = part / fastest;
  inputs_ = at.input;
  const auto potentialAt = [&](double step) {
    for (std::size_t k = 0; k < inputs_.size(); ++k)
      at.input[k] = inputs_[k] + step * at.inputRate[k];
    Energy energy;
    at.energies(energy.kinetic, energy.potential, energy.power);
    return energy.potential;
  };
  double power = 0;
  if (const double ahead = potentialAt(h); ahead != potential)
    power = (8 * (ahead - potentialAt(-h)) - (potentialAt(2 * h) - potentialAt(-2 * h))) / (12 * h);
  at.input = inputs_;
  return power;
}

// False: the motion cannot be evaluated there.
bool EnergyBalance::readPower(double time, const double *state, Power &power) {
  if (!dynamics_.evaluate(time, state, rate_.data()))
    return false;
  const Energy energy = energyAt(time, state);
  const double friction = dynamics_.frictionPower(), ofInputs = inputPower(energy.potential);
  power = {time, energy.power + ofInputs + dynamics_.reactionPower() - friction, friction};
  note(energy);
  return true;
}

// Of the integrator's step, whose parts follow one another.
bool EnergyBalance::readEnds(SmoothIntegrator &integrator) {
  constexpr double continuous = 1e-3;
  Power &earlier = totals_.earlier, &begin = totals_.begin, &end = totals_.end;
  if (begin.time == integrator.beginTime() && end.time == integrator.endTime())
    return true;
  const Power beginBefore = begin, endBefore = end;
  earlier = {};
  if (!readPower(integrator.beginTime(), integrator.begin(), begin) || !readPower(integrator.endTime(), integrator.end(), end)) {
    end = {};
    return false;
  }
  const auto goesOn = [&](double Power::*power) {
    const double before = endBefore.*power, now = begin.*power;
    return std::abs(now - before) <= continuous * std::max({std::abs(before), std::abs(now), std::abs(end.*power)});
  };
  if (endBefore.time == begin.time && goesOn(&Power::work) && goesOn(&Power::friction))
    earlier = beginBefore;
  return true;
}

// Parabolas through the powers at the ends of a step and at the begin of the one before; else lines.
EnergyBalance::Passage EnergyBalance::integrateEnds(double begin, double end) const {
  const Power &earlier = totals_.earlier, &first = totals_.begin, &last = totals_.end;
  const double h = last.time - first.time, a = (begin - first.time) / h, b = (end - first.time) / h;
  const double ratio = (first.time - earlier.time) / h;
  const auto integral = [&](double Power::*power) {
    const double change = last.*power - first.*power;
    // first + slope s + bend s (s − 1), s in [0, 1]
    const double bend = std::isnan(ratio) ? 0 : (change - (first.*power - earlier.*power) / ratio) / (1 + ratio);
    const auto primitive = [&](double s) { return s * (first.*power + s * (0.5 * change + bend * (s / 3 - 0.5))); };
    return h * (primitive(b) - primitive(a));
  };
  const double work = integral(&Power::work), friction = integral(&Power::friction);
  return {1, -friction, work, std::abs(work) + std::abs(friction)};
}

EnergyBalance::Passage EnergyBalance::integrate(SmoothIntegrator &integrator, const Quadrature &rule, double begin, double length) {
  Passage sum;
  const auto &[nodes, weights] = rule;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const double time = begin + nodes[k] * length;
    integrator.interpolate(time, state_.data());
    Power power;
    if (!readPower(time, state_.data(), power))
      continue;
    sum.known += weights[k];
    sum.frictionLoss -= weights[k] * power.friction;
    sum.work += weights[k] * power.work;
    sum.passed += weights[k] * (std::abs(power.work) + std::abs(power.friction));
  }
  const double scale = sum.known > 0 ? length / sum.known : 0;
  sum.frictionLoss *= scale;
  sum.work *= scale;
  sum.passed *= scale;
  return sum;
}

// The ends of the step have been projected, the interpolant has not.
EnergyBalance::Energy EnergyBalance::energyInside(SmoothIntegrator &integrator, double time) {
  if (time == integrator.beginTime())
    return energyAt(time, integrator.begin());
  if (time == integrator.endTime())
    return energyAt(time, integrator.end());
  integrator.interpolate(time, state_.data());
  return energyAt(time, state_.data());
}

// By halves, until they agree with the whole.
EnergyBalance::Passage EnergyBalance::refine(SmoothIntegrator &integrator, const Passage &whole, double begin, double length,
                                             double accepted, int depth) {
  constexpr Quadrature rule = {legendreNodes, legendreWeights};
  // Points that are hardly apart for rounding: what powers differ by there, as near a pole of contact forces, is rounding, too.
  constexpr double instant = 1e3 * std::numeric_limits<double>::epsilon();
  const double half = 0.5 * length;
  Passage first = integrate(integrator, rule, begin, half), second = integrate(integrator, rule, begin + half, half);
  const bool agree = std::abs(first.work + second.work - whole.work) <= accepted &&
                     std::abs(first.frictionLoss + second.frictionLoss - whole.frictionLoss) <= accepted;
  if (!agree && depth > 0 && half > instant * std::abs(begin)) {
    first = refine(integrator, first, begin, half, 0.5 * accepted, depth - 1);
    second = refine(integrator, second, begin + half, half, 0.5 * accepted, depth - 1);
  }
  return {0.5 * (first.known + second.known), first.frictionLoss + second.frictionLoss, first.work + second.work,
          first.passed + second.passed};
}

// What moves without any effect on the state, as a body whose position is a function of time, has no part in the error of the step: where
// the integrals do not explain how the energy has changed they need more points.
void EnergyBalance::addStep(SmoothIntegrator &integrator, double begin, double end) {
  constexpr double part = 1e-3;  // of the tolerance
  constexpr double clear = 100;  // what is less is the error of the step itself
  constexpr int deepest = 12;
  const double length = end - begin;
  // Inside a step of the stabilised method what is stiff is not resolved: the states there are as near as the tolerance wants, the powers
  // of a stiff damper in them are not.
  const bool usesEnds = integrator.isStabilised() && readEnds(integrator);
  const bool isWhole = begin == integrator.beginTime() && end == integrator.endTime();
  // Between the stages of a method that follows a slip of two components from zero its direction, out of small differences, is poor.
  const Quadrature stages = integrator.quadrature();
  const bool usesStages = isWhole && dynamics_.hasTurningSlips() && !stages.nodes.empty();
  // Of a small part; its energies tell whether that was enough.
  const bool isShort = length < 0.5 * (integrator.endTime() - integrator.beginTime());
  const Quadrature rule = usesStages ? stages : isShort ? Quadrature{shortNodes, shortWeights} : Quadrature{legendreNodes, legendreWeights};
  Passage passage = usesEnds ? integrateEnds(begin, end) : integrate(integrator, rule, begin, length);
  if (passage.known < 1 - *std::min_element(rule.weights.begin(), rule.weights.end()) / 2) {
    totals_.estimatedTime += length;
  } else if (const double unresolved = integrator.stiffness() * (integrator.endTime() - integrator.beginTime());
             unresolved > 1 || (!usesEnds && !usesStages)) {
    const double change = energyInside(integrator, end).mechanical() - energyInside(integrator, begin).mechanical();
    const double error = integrator.settings().tolerance * std::max(totals_.largest, totals_.passed), accepted = part * error;
    if (!usesEnds && !usesStages && std::abs(passage.work - passage.frictionLoss - change) > clear * accepted)
      passage = refine(integrator, passage, begin, length, accepted, deepest);
    // Damping that steps do not resolve, of a damper or of friction that turns, makes of the tolerance's error of a velocity one that is so
    // many times larger of its power: what that adds up to is what the energies tell.
    if (unresolved > 1 && passage.passed > 0) {
      const double most = integrator.stiffness() * length * error;
      const double missing = std::clamp(change - (passage.work - passage.frictionLoss), -most, most);
      if (std::abs(passage.work) >= std::abs(passage.frictionLoss))
        passage.work += missing;
      else
        passage.frictionLoss -= missing;
    }
  }
  totals_.frictionLoss += passage.frictionLoss;
  totals_.work += passage.work;
  totals_.passed += passage.passed;
}

void EnergyBalance::addImpact(double time, const double *before, const double *after, double boundaryWork) {
  const double afterwards = energyAt(time, after).kinetic, change = afterwards - energyAt(time, before).kinetic;
  const double work = boundaryWork + 0.5 * (afterwards - reversed(time, after) - (afterwards - change - reversed(time, before)));
  totals_.work += work;
  totals_.impactLoss += work - change;
  totals_.passed += std::abs(work) + std::abs(work - change);
}

// The kinetic energy with the opposite velocities. Where positions depend on time it has a part that is linear in the velocities, whose
// change in an impact is work of what moves the positions.
double EnergyBalance::reversed(double time, const double *state) {
  const tf_model &model = dynamics_.model().model();
  std::copy_n(state, state_.size(), state_.begin());
  for (int k = 0; k < model.nv; ++k)
    state_[model.nq + k] = -state_[model.nq + k];
  return energyAt(time, state_.data()).kinetic;
}

void EnergyBalance::addImpacts(double beginTime, const double *begin, double endTime, const double *end, double impactLoss,
                               double frictionLoss) {
  const double change = energyAt(endTime, end).mechanical() - energyAt(beginTime, begin).mechanical();
  const double work = change + frictionLoss + impactLoss;
  totals_.work += work;
  totals_.frictionLoss += frictionLoss;
  totals_.impactLoss += impactLoss;
  totals_.passed += std::abs(work) + std::abs(frictionLoss) + std::abs(impactLoss);
}

double EnergyBalance::error(double time, const double *state) {
  const Energy energy = energyAt(time, state);
  note(energy);
  const double expected = totals_.start + totals_.work - totals_.frictionLoss - totals_.impactLoss;
  return std::abs(energy.mechanical() - expected) / std::max(totals_.largest, totals_.passed);
}

}  // namespace tf::runtime
