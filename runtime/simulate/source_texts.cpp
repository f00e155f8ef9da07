#include "runtime/simulate/source_texts.h"

#include <fmt/format.h>

namespace tf::runtime {

std::string sourceOf(const tf_location &location) {
  return fmt::format("({}:{})", location.file != nullptr ? location.file : "", location.line);
}

std::string elementText(const tf_model &model, int element) {
  if (element < model.nc)
    return fmt::format("contact '{}' {}", model.contacts[element].name, sourceOf(model.contacts[element].location));
  const int friction = element - model.nc, condition = friction - model.nf;
  if (friction < model.nf)
    return fmt::format("friction element '{}' {}", model.frictions[friction].name, sourceOf(model.frictions[friction].location));
  return fmt::format("switch '{}' {}", model.switches[condition].text, sourceOf(model.switches[condition].location));
}

std::string negativeFrictionOf(const tf_contact &contact, double coefficient) {
  return fmt::format("the friction coefficient of contact '{}' is {:.6g}, it cannot be negative {}", contact.name, coefficient,
                     sourceOf(contact.location));
}

std::string negativeFrictionOf(const tf_friction &friction, double bound) {
  return fmt::format("the bound of friction element '{}' is {:.6g}, it cannot be negative {}", friction.name, bound,
                     sourceOf(friction.location));
}

}  // namespace tf::runtime
