// The LLVM module of a model.
#pragma once

#include "compiler/codegen/compiled_model.h"

#include <llvm/IR/Module.h>
#include <llvm/Target/TargetMachine.h>

#include <memory>

namespace tf::codegen {

[[nodiscard]] std::unique_ptr<llvm::Module> buildModule(const ModelSource &source, const CodegenOptions &options,
                                                        llvm::LLVMContext &context, const llvm::TargetMachine &machine);

}  // namespace tf::codegen
