#include "runtime/simulate/held_rates.h"

#include "runtime/simulate/source_texts.h"
#include "runtime/simulate/transitions.h"

#include <fmt/format.h>

#include <cmath>

namespace tf::runtime {

HeldRate largestHeldRate(ModelEvaluation &at, const Mode &mode, double time, const double *state) {
  const tf_model &model = at.model();
  HeldRate largest;
  const double *velocities = state + model.nq;
  const auto compare = [&largest](HeldRate::Kind kind, int element, double rate, double scale) {
    if (!(std::abs(rate) <= largest.size))
      largest = {kind, element, std::abs(rate), scale};
  };
  at.setPoint(time, state);
  at.switchingOfAll(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  for (int i = 0; i < model.nc; ++i)
    if (mode.closed[i])
      compare(HeldRate::Kind::Gap, i, at.gapRate[i], at.scales.gapRate(i, velocities));
  for (int j = 0; j < model.nt; ++j)
    if (mode.tangent[j] == Tangent::Stick)
      compare(HeldRate::Kind::Slip, j, at.slip[j], at.scales.slip(j, velocities));
  if (model.nh > 0)
    at.constraintResiduals();
  for (int k = 0; k < model.nk; ++k)
    for (int row = model.constraints[k].row_first, end = row + model.constraints[k].row_count; row < end; ++row)
      compare(HeldRate::Kind::Constraint, k, at.residualRate[row], at.scales.residualRate(row, velocities));
  return largest;
}

HeldRate largestHeldValue(ModelEvaluation &at, const Mode &mode, double time, const double *state) {
  const tf_model &model = at.model();
  HeldRate largest;
  const auto compare = [&largest](HeldRate::Kind kind, int element, double value, double scale) {
    if (!(std::abs(value) <= largest.size))
      largest = {kind, element, std::abs(value), scale};
  };
  at.setPoint(time, state);
  at.switchingOfAll(ModelEvaluation::Gaps);
  for (int i = 0; i < model.nc; ++i)
    if (mode.closed[i])
      compare(HeldRate::Kind::Gap, i, at.gap[i], at.scales.gap(i, state));
  if (model.nh > 0)
    at.constraintResiduals();
  for (int k = 0; k < model.nk; ++k)
    for (int row = model.constraints[k].row_first, end = row + model.constraints[k].row_count; row < end && model.constraints[k].holonomic;
         ++row)
      compare(HeldRate::Kind::Constraint, k, at.residual[row], at.scales.residual(row));
  return largest;
}

std::string nameOf(const tf_model &model, const HeldRate &rate) {
  const auto text = [](std::string_view what, const auto &element) {
    return fmt::format("{} '{}' {}", what, element.name, sourceOf(element.location));
  };
  if (rate.kind == HeldRate::Kind::Gap)
    return text("the gap of contact", model.contacts[rate.element]);
  if (rate.kind == HeldRate::Kind::Constraint)
    return text("constraint", model.constraints[rate.element]);
  const int element = elementOfTangent(model, rate.element);
  return element < model.nc ? text("the slip of contact", model.contacts[element])
                            : text("the slip of friction element", model.frictions[element - model.nc]);
}

}  // namespace tf::runtime
