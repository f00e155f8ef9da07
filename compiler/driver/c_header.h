// `--emit header`: what a C program needs to use a compiled model by name.
#pragma once

#include "compiler/mechanics/hybrid_system.h"

#include <string>

namespace tf::driver {

// Sizes and the numbers of the variables (for tf_get) as enumerators, with units and descriptions as comments.
[[nodiscard]] std::string cHeader(const HybridSystem &system);

}  // namespace tf::driver
