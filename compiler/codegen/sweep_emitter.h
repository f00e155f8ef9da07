// LLVM IR of the loop of a sweep (ir/function.h): several colours at a time, one in each lane of the vectors in the sweep's frame.
#pragma once

#include "compiler/ir/function.h"

#include <llvm/IR/IRBuilder.h>

#include <functional>

namespace tf::codegen {

// The function that runs the loop, at whose end `builder` stands.
struct SweepContext {
  llvm::IRBuilder<> &builder;
  llvm::Value *inputs, *outputs, *mask, *frame;
};

// Rows of the frame: seeds, then results.
[[nodiscard]] inline int firstResultRow(const ir::Sweep &sweep) { return sweep.seedCount; }
[[nodiscard]] inline int firstSlotRow(const ir::Sweep &sweep) { return sweep.seedCount + static_cast<int>(sweep.results.size()); }

// Emits: for each group of colours of which a row is selected, set the seeds, `emitBody`, store the entries; or the same once for the
// directions of the caller. `name` begins the names of the tables.
void emitSweep(const ir::Sweep &sweep, const std::string &name, const SweepContext &context, const std::function<void()> &emitBody);

}  // namespace tf::codegen
