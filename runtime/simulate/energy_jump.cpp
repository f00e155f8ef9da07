#include "runtime/simulate/energy_jump.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Switches are found to about 1e-12; functions that are continuous there change by that times their slopes.
constexpr double clear = 1e-6, clearPotential = 1e-4;

}  // namespace

EnergyJump::Energies EnergyJump::evaluate(double time, const double *state) {
  const tf_model &model = at_.model();
  Energies energies;
  double power = 0;
  std::copy_n(state, probe_.size(), probe_.begin());
  double *velocities = probe_.data() + model.nq;
  at_.setPoint(time, probe_.data());
  std::fill_n(velocities, model.nv, 0.0);
  at_.energies(energies.atRest, energies.potential, power);
  std::fill_n(velocities, model.nv, 1.0);
  at_.energies(energies.kinetic, energies.potential, power);
  return energies;
}

bool EnergyJump::potentialJumps() const {
  const double largest = std::max({std::abs(before_.potential), std::abs(after_.potential), before_.kinetic, after_.kinetic});
  return std::abs(ofPotential()) > clearPotential * largest;
}

bool EnergyJump::kineticJumps() const {
  const auto jumps = [](double before, double after, double largest) { return std::abs(after - before) > clear * largest; };
  const double largest = std::max(before_.kinetic, after_.kinetic);
  return jumps(before_.kinetic, after_.kinetic, largest) || jumps(before_.atRest, after_.atRest, largest);
}

}  // namespace tf::runtime
