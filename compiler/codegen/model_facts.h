// What the model's table says beyond the system's own lists.
#pragma once

#include "compiler/mechanics/hybrid_system.h"

namespace tf::codegen {

// Length of the longest chain of bound parameters that depend on one another; 0 if none is bound.
[[nodiscard]] int bindingDepth(const HybridSystem &system);
// M depends on parameters only.
[[nodiscard]] bool massIsConstant(const HybridSystem &system);

}  // namespace tf::codegen
