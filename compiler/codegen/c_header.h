// `--emit header`: what a C program needs to use a compiled model by name: numbers of elements and the places of its quantities.
#pragma once

#include "compiler/mechanics/hybrid_system.h"

#include <string>

namespace tf {

// Text of a C header that includes runtime/abi/tf_model.h. One constant for each quantity, alias, contact, friction element and switch;
// names that C does not allow are spelt with underscores, and numbered where that makes two the same.
[[nodiscard]] std::string emitHeader(const HybridSystem &system);

}  // namespace tf
