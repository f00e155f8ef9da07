// What a mode holds at zero: the gaps of closed contacts, constraints, their rates, and slips that stick.
#pragma once

#include "runtime/integrate/mode.h"
#include "runtime/integrate/model_evaluation.h"

#include <string>

namespace tf::runtime {

// The largest of some rates, or of some gaps and residuals.
struct HeldRow {
  enum class Kind : std::uint8_t { None, Gap, Slip, Constraint };
  Kind kind = Kind::None;
  int element = -1;  // contact, tangential row or constraint
  double size = 0;
  double scale = 0;  // of what it is a difference of

  void include(Kind otherKind, int otherElement, double value, double otherScale);
};

// At (time, state), which becomes the evaluation's point: of the rates, with slips,
[[nodiscard]] HeldRow largestHeldRate(ModelEvaluation &at, const Mode &mode, double time, const double *state);
// and of the gaps and residuals themselves.
[[nodiscard]] HeldRow largestHeldValue(ModelEvaluation &at, const Mode &mode, double time, const double *state);

// "the gap of contact 'c' (file:line)"
[[nodiscard]] std::string nameOf(const tf_model &model, const HeldRow &held);

}  // namespace tf::runtime
