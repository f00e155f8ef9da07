// Values of the model's variables (result columns) at a point.
#pragma once

#include "runtime/integrate/mode_dynamics.h"

#include <vector>

namespace tf::runtime {

class VariableValues {
public:
  explicit VariableValues(ModeDynamics &dynamics);

  // All variables of the model's table at (time, state) in the dynamics' mode; impulse [nc] and parameters [np] are passed through. False:
  // the dynamics cannot be evaluated there (accelerations and forces are those of the last evaluation then).
  bool evaluate(double time, const double *state, const double *impulse, const double *parameters, double *all);

private:
  double value(const tf_variable &variable, double time, const double *state, const double *impulse, const double *parameters) const;

  [[nodiscard]] double push(int contact) const;
  [[nodiscard]] double slipStep(int row) const;

  ModeDynamics &dynamics_;
  std::vector<int> owner_;  // contact of a tangential row, −1 of a friction element
  std::vector<double> rate_, outputs_;
};

}  // namespace tf::runtime
