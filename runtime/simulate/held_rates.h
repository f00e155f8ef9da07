// Rates that a mode holds at zero: of the gaps of closed contacts, slips that stick, constraints.
#pragma once

#include "runtime/integrate/mode.h"
#include "runtime/integrate/model_evaluation.h"

#include <string>

namespace tf::runtime {

struct HeldRate {
  enum class Kind : std::uint8_t { None, Gap, Slip, Constraint };
  Kind kind = Kind::None;
  int element = -1;  // contact, tangential row or constraint
  double size = 0;
  double scale = 0;  // of velocities that it is a difference of
};

// The largest of them at (time, state), which becomes the evaluation's point.
[[nodiscard]] HeldRate largestHeldRate(ModelEvaluation &at, const Mode &mode, double time, const double *state);
// The same of the gaps and residuals themselves.
[[nodiscard]] HeldRate largestHeldValue(ModelEvaluation &at, const Mode &mode, double time, const double *state);

// "the gap of contact 'c' (file:line)"
[[nodiscard]] std::string nameOf(const tf_model &model, const HeldRate &rate);

}  // namespace tf::runtime
