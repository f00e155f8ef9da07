// Bounds of friction that depend on the direction of their own slip. A stick has no direction, so that they would not say what holds it.
#pragma once

#include "compiler/mechanics/elements.h"
#include "compiler/mechanics/hybrid_system.h"

namespace tf::mechanics {

// The switch by which the element's bound has another value on the other side of where its slip is zero, or −1. Found at a few points of no
// regularity; attributes are resolved.
[[nodiscard]] int switchOnSlipDirection(const HybridSystem &system, const FrictionEntry &friction);

}  // namespace tf::mechanics
