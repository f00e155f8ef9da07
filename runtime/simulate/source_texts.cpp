#include "runtime/simulate/source_texts.h"

#include <fmt/format.h>

namespace tf::runtime {

std::string sourceOf(const tf_location &location) {
  return fmt::format("({}:{})", location.file != nullptr ? location.file : "", location.line);
}

std::string negativeFrictionOf(const tf_contact &contact, double coefficient) {
  return fmt::format("the friction coefficient of contact '{}' is {:.6g}, it cannot be negative {}", contact.name, coefficient,
                     sourceOf(contact.location));
}

}  // namespace tf::runtime
