// The impact of one contact with friction in one direction or none (theory.md section 3): at most five pieces in closed form. The same path
// as FrozenPhase, which follows any number of contacts.
#pragma once

#include "runtime/contact/frozen_phase.h"

namespace tf::runtime {

class SingleContactPhase {
public:
  // Null: more than one contact, or a case that needs more care (the contact is pressed in by friction, or its velocity is that of
  // rounding); then FrozenPhase finds the path. The pointer is valid until the next call. Allocates nothing after the first call.
  const FrozenResult *run(const FrozenProblem &problem);

private:
  FrozenResult result_;
};

}  // namespace tf::runtime
