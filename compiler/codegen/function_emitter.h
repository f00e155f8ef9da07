// LLVM IR of one ir::Function: straight-line code by units, guards as branches on the mask, a sweep as a loop.
#pragma once

#include "compiler/codegen/code_plan.h"
#include "compiler/ir/graph.h"

#include <llvm/IR/Module.h>

namespace tf::codegen {

// Adds `internal void @name(ptr in, ptr out, ptr mask)` (tf_function of runtime/abi/tf_model.h) to the module, and its pieces if the plan
// is split. Output arrays must not overlap input arrays. No fast-math and no contraction: every operation rounds once, as in ir::evaluate.
llvm::Function *emitFunction(const ir::Function &function, const ir::Graph &graph, const CodePlan &plan, llvm::Module &module);

}  // namespace tf::codegen
