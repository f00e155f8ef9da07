#include "runtime/simulate/energy_balance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tf::runtime {

namespace {

// Gauss–Legendre quadrature with four points on [0, 1], order 8.
constexpr std::array<double, 4> legendreNodes = {0.069431844202973712, 0.330009478207571868, 0.669990521792428132, 0.930568155797026288};
constexpr std::array<double, 4> legendreWeights = {0.173927422568726929, 0.326072577431273071, 0.326072577431273071, 0.173927422568726929};

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

void EnergyBalance::addStep(SmoothIntegrator &integrator) {
  const double begin = integrator.beginTime(), length = integrator.endTime() - begin;
  // Between the stages of a method that follows a slip of two components from zero its direction, out of small differences, is poor.
  Quadrature rule = integrator.quadrature();
  if (!dynamics_.hasTurningSlips() || rule.nodes.empty())
    rule = {legendreNodes, legendreWeights};
  const auto &[nodes, weights] = rule;
  double known = 0, loss = 0, work = 0, passed = 0;  // weights of the points that count, and the means there
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const double time = begin + nodes[k] * length;
    integrator.interpolate(time, state_.data());
    if (!dynamics_.evaluate(time, state_.data(), rate_.data()))
      continue;
    const Energy energy = energyAt(time, state_.data());
    const double friction = dynamics_.frictionPower();
    known += weights[k];
    loss -= weights[k] * friction;
    const double power = energy.power + dynamics_.reactionPower() - friction;
    work += weights[k] * power;
    passed += weights[k] * (std::abs(power) + std::abs(friction));
    note(energy);
  }
  if (known > 0) {
    totals_.frictionLoss += length * loss / known;
    totals_.work += length * work / known;
    totals_.passed += length * passed / known;
  }
  if (known < 1 - *std::min_element(weights.begin(), weights.end()) / 2)
    totals_.estimatedTime += length;
}

void EnergyBalance::addImpact(double time, const double *before, const double *after, double boundaryWork) {
  const double change = energyAt(time, after).kinetic - energyAt(time, before).kinetic;
  totals_.work += boundaryWork;
  totals_.impactLoss += boundaryWork - change;
  totals_.passed += std::abs(boundaryWork) + std::abs(boundaryWork - change);
}

void EnergyBalance::addImpacts(double beginTime, const double *begin, double endTime, const double *end, double work, double frictionLoss) {
  const double change = energyAt(endTime, end).mechanical() - energyAt(beginTime, begin).mechanical();
  const double impactLoss = work - frictionLoss - change;
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
