// Sine and cosine in generated code.
#pragma once

#include <llvm/IR/Function.h>
#include <llvm/IR/Module.h>

namespace tf::codegen {

// {double, double} (double): sine and cosine of the argument, the bits of tf::sineAndCosine. Made when it is first asked for.
llvm::Function *sineAndCosineFunction(llvm::Module &module);

}  // namespace tf::codegen
