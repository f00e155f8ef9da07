// The functions of the C math library that generated code may call. Nothing else is called, but for other generated functions and memset.
#pragma once

#include "compiler/ir/graph.h"

#include <llvm/IR/DerivedTypes.h>
#include <llvm/IR/Module.h>

#include <span>
#include <string_view>

namespace tf::codegen {

struct LibraryFunction {
  std::string_view name;
  void *address;  // in this process
};

// The math library's name of an operation; empty if the operation is not a call.
[[nodiscard]] std::string_view libraryName(ir::Op op);
// Its declaration in a module, of so many numbers.
[[nodiscard]] llvm::FunctionCallee mathFunction(llvm::Module &module, std::string_view name, std::size_t argumentCount);
// Also what the back end may call by itself (sincos, memset; fma where the processor has none).
[[nodiscard]] std::span<const LibraryFunction> libraryFunctions();

}  // namespace tf::codegen
