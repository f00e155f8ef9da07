#include "runtime/simulate/held_rates.h"

#include "runtime/simulate/source_texts.h"
#include "runtime/simulate/transitions.h"

#include <fmt/format.h>

#include <cmath>

namespace tf::runtime {

void HeldRow::include(Kind otherKind, int otherElement, double value, double otherScale) {
  if (!(std::abs(value) <= size))
    *this = {otherKind, otherElement, std::abs(value), otherScale};
}

HeldRow largestHeldRate(ModelEvaluation &at, const Mode &mode, double time, const double *state) {
  const tf_model &model = at.model();
  HeldRow largest;
  const double *velocities = state + model.nq;
  at.setPoint(time, state);
  at.switchingOfAll(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  for (int i = 0; i < model.nc; ++i)
    if (mode.closed[i])
      largest.include(HeldRow::Kind::Gap, i, at.gapRate[i], at.scales.gapRate(i, velocities));
  for (int j = 0; j < model.nt; ++j)
    if (mode.tangent[j] == Tangent::Stick)
      largest.include(HeldRow::Kind::Slip, j, at.slip[j], at.scales.slip(j, velocities));
  if (model.nh > 0)
    at.constraintResiduals();
  for (int k = 0; k < model.nk; ++k)
    for (int row = model.constraints[k].row_first, end = row + model.constraints[k].row_count; row < end; ++row)
      largest.include(HeldRow::Kind::Constraint, k, at.residualRate[row], at.scales.residualRate(row, velocities));
  return largest;
}

HeldRow largestHeldValue(ModelEvaluation &at, const Mode &mode, double time, const double *state) {
  const tf_model &model = at.model();
  HeldRow largest;
  at.setPoint(time, state);
  at.switchingOfAll(ModelEvaluation::Gaps);
  for (int i = 0; i < model.nc; ++i)
    if (mode.closed[i])
      largest.include(HeldRow::Kind::Gap, i, at.gap[i], at.scales.gap(i, state));
  if (model.nh > 0)
    at.constraintResiduals();
  for (int k = 0; k < model.nk; ++k)
    for (int row = model.constraints[k].row_first, end = row + model.constraints[k].row_count; row < end && model.constraints[k].holonomic;
         ++row)
      largest.include(HeldRow::Kind::Constraint, k, at.residual[row], at.scales.residual(row));
  return largest;
}

std::string nameOf(const tf_model &model, const HeldRow &held) {
  const auto text = [](std::string_view what, const auto &element) {
    return fmt::format("{} '{}' {}", what, element.name, sourceOf(element.location));
  };
  if (held.kind == HeldRow::Kind::Gap)
    return text("the gap of contact", model.contacts[held.element]);
  if (held.kind == HeldRow::Kind::Constraint)
    return text("constraint", model.constraints[held.element]);
  const int element = elementOfTangent(model, held.element);
  return element < model.nc ? text("the slip of contact", model.contacts[element])
                            : text("the slip of friction element", model.frictions[element - model.nc]);
}

}  // namespace tf::runtime
