// The host as LLVM's target: optimisation and translation of modules.
#pragma once

#include "compiler/codegen/compiled_model.h"

#include <llvm/IR/Module.h>
#include <llvm/Support/CodeGen.h>
#include <llvm/Target/TargetMachine.h>

#include <memory>
#include <string>

namespace tf::codegen {

// The host with all its features, position-independent, contraction off. Throws std::runtime_error if LLVM lacks the target.
[[nodiscard]] std::unique_ptr<llvm::TargetMachine> hostMachine(int optimization);
void optimize(llvm::Module &module, llvm::TargetMachine &machine, int optimization);
// Assembly text or object bytes. The module may be changed.
[[nodiscard]] std::string translate(llvm::Module &module, llvm::TargetMachine &machine, llvm::CodeGenFileType type);

}  // namespace tf::codegen
