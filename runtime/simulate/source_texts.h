// Parts of messages that name elements of the model and where they stand in its source.
#pragma once

#include "runtime/abi/tf_model.h"

#include <string>

namespace tf::runtime {

// "(file:line)"
[[nodiscard]] std::string sourceOf(const tf_location &location);

// "contact 'floor' (file:line)": of an event's element (Transition), which must be one.
[[nodiscard]] std::string elementText(const tf_model &model, int element);

// A contact's friction coefficient, or a friction element's bound, at some point is below zero.
[[nodiscard]] std::string negativeFrictionOf(const tf_contact &contact, double coefficient);
[[nodiscard]] std::string negativeFrictionOf(const tf_friction &friction, double bound);

}  // namespace tf::runtime
