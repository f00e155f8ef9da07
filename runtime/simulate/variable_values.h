// Values of the model's variables (result columns) at a point.
#pragma once

#include "runtime/integrate/mode_dynamics.h"
#include "runtime/simulate/energy_balance.h"

#include <vector>

namespace tf::runtime {

class VariableValues {
public:
  explicit VariableValues(ModeDynamics &dynamics);

  // Where work and losses come from; null: they are not known (NaN).
  void setEnergyBalance(const EnergyBalance *energy) { energy_ = energy; }

  // All variables of the model's table at (time, state) in the dynamics' mode; impulse [nc] and parameters [np] are passed through. False:
  // the dynamics cannot be evaluated there (accelerations and forces are those of the last evaluation then).
  bool evaluate(double time, const double *state, const double *impulse, const double *parameters, double *all);

private:
  double value(const tf_variable &variable, double time, const double *state, const double *impulse, const double *parameters) const;

  [[nodiscard]] double energyTotal(double EnergyTotals::*total) const;
  [[nodiscard]] double push(int contact) const;
  [[nodiscard]] double slipStep(int row) const;
  [[nodiscard]] bool sticks(int row) const;

  ModeDynamics &dynamics_;
  const EnergyBalance *energy_ = nullptr;
  bool hasEnergies_ = false;
  double kinetic_ = 0, potential_ = 0;
  std::vector<int> owner_;      // contact of a tangential row, −1 of a friction element
  std::vector<int> stickRows_;  // nt: how many rows from this one on stick together
  std::vector<bool> isPaired_;  // tangential rows: of slips with two components
  std::vector<double> rate_, outputs_;
};

}  // namespace tf::runtime
