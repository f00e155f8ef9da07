// An object file loaded into this process by LLVM's JIT linker.
#pragma once

#include "compiler/codegen/codegen.h"

#include <memory>
#include <string>

namespace tf::codegen {

// Throws std::runtime_error if the object cannot be loaded.
[[nodiscard]] std::unique_ptr<CompiledInMemory> loadObject(const std::string &object);

}  // namespace tf::codegen
