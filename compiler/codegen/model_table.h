// The constant of type tf_model (runtime/abi/tf_model.h) with its tables and strings.
#pragma once

#include "compiler/codegen/compiled_model.h"

#include <llvm/IR/Module.h>

#include <span>
#include <string>

namespace tf::codegen {

// Adds it under TF_MODEL_SYMBOL; `functions` in the order of the table's pointers, null where there is none.
void emitModelTable(const HybridSystem &system, const SourceManager &sources, const std::string &hash,
                    std::span<llvm::Function *const> functions, llvm::Module &module);

}  // namespace tf::codegen
