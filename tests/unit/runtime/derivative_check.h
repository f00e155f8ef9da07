// Validates the first derivatives of a compiled model against central differences of its functions.
#pragma once

#include "runtime/abi/tf_model.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tf::runtime::test {

// One value per argument of generated functions, tf_in order.
struct EvaluationPoint {
  std::array<std::vector<double>, TF_IN_COUNT> in;
};

// Reproducible values in [-1, 1] (times and forces too; step variables in [0, 1]; parameters as given, np of them).
EvaluationPoint randomPoint(const tf_model &model, std::vector<double> parameters, std::uint32_t seed);

// dynamics_derivatives, switch_gradients, step_derivatives, the contacts' Jacobians (as derivatives of gap rates and slips by v), gap rates
// (as time derivatives of gaps along q' and t) and the accelerations' biases, each against differences, and masks: masked rows are
// untouched; kinematics and constraints likewise. One line per entry that differs by more than tolerance * (1 + |value|); empty if all is
// well.
std::vector<std::string> checkDerivatives(const tf_model &model, const EvaluationPoint &point, double tolerance);

}  // namespace tf::runtime::test
