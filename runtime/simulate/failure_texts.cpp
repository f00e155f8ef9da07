#include "runtime/simulate/failure_texts.h"

#include "runtime/simulate/source_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// The sign of a NaN means nothing.
std::string_view nameOfNonFinite(double value) { return std::isnan(value) ? "NaN" : value > 0 ? "infinity" : "-infinity"; }

// Disks whose radius the selection of modes could take for zero.
constexpr double leastSlipRadius = 1e-9;

// The largest gap of a contact that starts closed, relative to its scale.
constexpr double touchingGap = 1e-9;

// `slips`: of the element's rows.
template <class Element> std::string slipRadius(std::string_view kind, const Element &element, const double *slips) {
  if (element.friction_form != TF_FRICTION_RELAXED)
    return {};
  const double radius = relaxedSlipRadius(slips + element.tangent_first + TF_RELAXED_STEADY_ROW);
  if (radius >= leastSlipRadius)
    return {};
  return fmt::format("{} '{}' has slipRadius {:.4g}; a run needs {:.4g} or more {}", kind, element.name, radius, leastSlipRadius,
                     sourceOf(element.location));
}

}  // namespace

std::string FailureTexts::contactParameters() {
  for (int i = 0; i < model_.nc; ++i) {
    const tf_contact &contact = model_.contacts[i];
    if (!(at_.restitution[i] >= 0 && at_.restitution[i] <= 1))
      return fmt::format("contact '{}' has restitution {}; it must be between 0 and 1 {}", contact.name, at_.restitution[i],
                         sourceOf(contact.location));
    if (!(at_.rate[i] > 0))
      return fmt::format("contact '{}' has rate {}; it must be positive {}", contact.name, at_.rate[i], sourceOf(contact.location));
  }
  return {};
}

std::string FailureTexts::slipRadii() {
  if (!hasRelaxedSlips(model_))
    return {};
  at_.switchingOfAll(ModelEvaluation::Slips);
  std::string text;
  for (int i = 0; i < model_.nc && text.empty(); ++i)
    text = slipRadius("contact", model_.contacts[i], at_.slip.data());
  for (int i = 0; i < model_.nf && text.empty(); ++i)
    text = slipRadius("friction element", model_.frictions[i], at_.slip.data());
  return text;
}

// Differences of functions would have to be taken within the disk.
std::string FailureTexts::relaxedSensitivities() const {
  const auto text = [](std::string_view kind, const auto &element) {
    return fmt::format("sensitivities need FrictionForm.Exact or .Polyhedral, but {} '{}' has .Relaxed {}", kind, element.name,
                       sourceOf(element.location));
  };
  for (int i = 0; i < model_.nc; ++i)
    if (model_.contacts[i].friction_form == TF_FRICTION_RELAXED)
      return text("contact", model_.contacts[i]);
  for (int i = 0; i < model_.nf; ++i)
    if (model_.frictions[i].friction_form == TF_FRICTION_RELAXED)
      return text("friction element", model_.frictions[i]);
  return {};
}

std::string FailureTexts::contactsAtStart(double time, const double *state) {
  at_.setPoint(time, state);
  if (std::string text = negativeFriction(); !text.empty())
    return text;
  if (std::string text = slipRadii(); !text.empty())
    return text;
  // Gaps of contacts that are asleep are positive.
  at_.switching(ModelEvaluation::Gaps);
  for (int i = 0; i < model_.nc; ++i) {
    const tf_contact &contact = model_.contacts[i];
    if (!std::isfinite(at_.gap[i]))
      return fmt::format("'{}.gap' is {} at the start {}", contact.name, nameOfNonFinite(at_.gap[i]), sourceOf(contact.location));
    // Most are open: their scales are not needed.
    if (at_.gap[i] < 0 && at_.gap[i] < -touchingGap * at_.scales.gap(i, state))
      return fmt::format("contact '{}' starts with a penetration of {:.6g} {}", contact.name, -at_.gap[i], sourceOf(contact.location));
  }
  return {};
}

std::string FailureTexts::startValues(const double *state) const {
  const int count = model_.nq + model_.nv + model_.nz;
  const double *bad = std::find_if(state, state + count, [](double value) { return !std::isfinite(value); });
  if (bad == state + count)
    return {};
  const int i = static_cast<int>(bad - state), velocity = i - model_.nq, other = velocity - model_.nv;
  const std::string name = velocity < 0 ? instance_.nameOf(TF_KIND_COORDINATE, i)
                           : other < 0  ? instance_.nameOf(TF_KIND_VELOCITY, velocity)
                                        : instance_.nameOf(TF_KIND_STATE, other);
  // Starts of rotations are normalised.
  const std::int32_t *rotations = model_.quaternions;
  if (std::any_of(rotations, rotations + model_.nr, [i](int first) { return i >= first && i < first + 4; }))
    return fmt::format("the start of the rotation '{}' is no quaternion: its elements are 0, or no numbers",
                       name.substr(0, name.rfind(".q[")));
  return fmt::format("the start of '{}' is {}", name, nameOfNonFinite(*bad));
}

std::string FailureTexts::negativeFriction(const Mode *mode) {
  at_.contactTerms(all_.data());
  for (int i = 0; i < model_.nc; ++i)
    if (at_.friction[i] < -negligibleFriction && (mode == nullptr || mode->closed[i]))
      return negativeFrictionOf(model_.contacts[i], at_.friction[i]);
  for (int i = 0; i < model_.nf; ++i)
    if (const double bound = at_.bound[model_.frictions[i].tangent_first]; bound < -negligibleFriction)
      return negativeFrictionOf(model_.frictions[i], bound);
  return {};
}

std::string FailureTexts::singularMass() const {
  const int row = std::max(at_.mobility.mass().failedRow(), 0);
  const std::string name = instance_.nameOf(model_.nq == model_.nv ? TF_KIND_COORDINATE : TF_KIND_VELOCITY, row);
  for (int column = 0; column < model_.nv; ++column)
    if (const double entry = at_.massMatrix[static_cast<std::size_t>(row) * model_.nv + column]; !std::isfinite(entry))
      return fmt::format("{} in the inertia that acts on '{}'", nameOfNonFinite(entry), name);
  if (const double inertia = at_.massMatrix[static_cast<std::size_t>(row) * (model_.nv + 1)]; inertia < 0)
    return fmt::format("the inertia that acts on '{}' is {:.6g}, it cannot be negative", name, inertia);
  return fmt::format("the mass matrix is singular: no inertia acts on '{}'", name);
}

std::string FailureTexts::evaluation() {
  const double time = at_.time();
  switch (dynamics_.failure()) {
  case EvaluationFailure::None:
    return fmt::format("the implicit equations of a step to an event have no solution at t = {:.10g}", time);
  case EvaluationFailure::SingularMass:
    return fmt::format("{} at t = {:.10g}", singularMass(), time);
  case EvaluationFailure::SingularContact:
    if (const std::string text = nonFinite(); !text.empty())
      return fmt::format("{} at t = {:.10g}", text, time);
    return fmt::format("the contact forces have no solution at t = {:.10g}", time);
  case EvaluationFailure::SlidingDiverged:
    return fmt::format("the sliding mode of the switches has no solution at t = {:.10g}", time);
  case EvaluationFailure::NotFinite:
    break;
  }
  const std::string text = nonFinite();
  return fmt::format("{} at t = {:.10g}", text.empty() ? "a value that is not finite" : text, time);
}

std::string FailureTexts::place(tf_kind kind, int index) const {
  const std::int32_t variable = instance_.variableOf(kind, index);
  const std::string name = instance_.nameOf(kind, index);
  return variable < 0 ? fmt::format("'{}'", name) : fmt::format("'{}' {}", name, sourceOf(model_.variables[variable].location));
}

std::string FailureTexts::nonFinite() {
  for (int i = 0; i < model_.nz; ++i)
    if (!std::isfinite(at_.stateRate[i]))
      return fmt::format("{} in {}", nameOfNonFinite(at_.stateRate[i]), place(TF_KIND_STATE_DERIVATIVE, i));
  for (int i = 0; i < model_.nv; ++i)
    if (!std::isfinite(at_.force[i]) || !std::isfinite(at_.massMatrix[i * model_.nv + i]))
      return fmt::format("{} in {}", nameOfNonFinite(std::isfinite(at_.force[i]) ? at_.massMatrix[i * model_.nv + i] : at_.force[i]),
                         place(TF_KIND_ACCELERATION, i));
  if (std::string text = nonFiniteConstraint(); !text.empty())
    return text;
  return nonFiniteContact();
}

std::string FailureTexts::undefinedContact(double time, const double *state) {
  at_.setPoint(time, state);
  return nonFiniteContact();
}

std::string FailureTexts::nonFiniteContact() {
  at_.switchingOfAll(ModelEvaluation::Gaps | ModelEvaluation::Slips);
  at_.contactTerms(all_.data());
  const auto firstOf = [](const double *first, int count) {
    const double *bad = std::find_if(first, first + count, [](double value) { return !std::isfinite(value); });
    return bad == first + count ? 0.0 : *bad;
  };
  const auto found = [](double value, std::string_view what, std::string_view kind, const char *name, const tf_location &location) {
    return fmt::format("{} in the {} of {} '{}' {}", nameOfNonFinite(value), what, kind, name, sourceOf(location));
  };
  const auto slipOf = [&](int row, int count) {
    for (; count > 0; ++row, --count)
      for (const double value : {at_.slip[row], at_.tangentBias[row], firstOf(at_.tangent.data() + row * model_.nv, model_.nv)})
        if (!std::isfinite(value))
          return value;
    return 0.0;
  };
  for (int i = 0; i < model_.nc; ++i) {
    const tf_contact &contact = model_.contacts[i];
    for (const double value : {at_.gap[i], at_.gapRate[i], at_.normalBias[i], firstOf(at_.normal.data() + i * model_.nv, model_.nv)})
      if (!std::isfinite(value))
        return found(value, "gap", "contact", contact.name, contact.location);
    // Nobody reads the slip of an open contact.
    if (at_.gap[i] > touchingGap * at_.scales.gap(i, at_.coordinates()))
      continue;
    if (const double value = slipOf(contact.tangent_first, contact.tangent_count); !std::isfinite(value))
      return found(value, "slip", "contact", contact.name, contact.location);
    if (!std::isfinite(at_.friction[i]))
      return found(at_.friction[i], "friction coefficient", "contact", contact.name, contact.location);
  }
  for (int i = 0; i < model_.nf; ++i) {
    const tf_friction &friction = model_.frictions[i];
    if (const double value = slipOf(friction.tangent_first, friction.tangent_count); !std::isfinite(value))
      return found(value, "slip", "friction element", friction.name, friction.location);
    if (const double bound = at_.bound[friction.tangent_first]; !std::isfinite(bound))
      return found(bound, "bound", "friction element", friction.name, friction.location);
  }
  return {};
}

std::string FailureTexts::nonFiniteConstraint() {
  at_.constraintRows();
  for (int k = 0; k < model_.nk; ++k) {
    const tf_constraint &constraint = model_.constraints[k];
    for (int row = constraint.row_first; row < constraint.row_first + constraint.row_count; ++row) {
      const double *first = at_.constraintJacobian.data() + static_cast<std::ptrdiff_t>(row) * model_.nv;
      const double *bad = std::find_if(first, first + model_.nv, [](double value) { return !std::isfinite(value); });
      if (const double value = bad != first + model_.nv ? *bad : at_.constraintBias[row]; !std::isfinite(value))
        return fmt::format("{} in the derivative of constraint '{}' {}", nameOfNonFinite(value), constraint.name,
                           sourceOf(constraint.location));
    }
  }
  return {};
}

}  // namespace tf::runtime
