// From a system and its functions to every form of code. What tf_make_code_generator does, with the functions as an argument.
#pragma once

#include "compiler/codegen/codegen.h"
#include "compiler/ir/function.h"

#include <memory>
#include <span>
#include <string>

namespace tf::codegen {

// The number of function pointers in tf_model.
inline constexpr std::size_t modelFunctionCount = 16;

// `functions`: in the order of the function pointers of tf_model; an empty name gives a null pointer.
struct ModelSource {
  const HybridSystem &system;
  std::span<const ir::Function> functions;
  const SourceManager &sources;
};

// The same input gives the same bytes. Throw std::runtime_error as CodeGenerator does.
[[nodiscard]] std::string emit(const ModelSource &source, EmitKind kind, const CodegenOptions &options);
[[nodiscard]] std::unique_ptr<CompiledInMemory> compileInMemory(const ModelSource &source, const CodegenOptions &options);
// "cpu +feature,-feature LLVM-19.1.4".
[[nodiscard]] std::string hostDescription();

}  // namespace tf::codegen
