// Code generation: the functions of a HybridSystem through LLVM to memory, object file, shared library or text. The only folder that sees
// LLVM; it is a shared library of its own (libtfcodegen) that the program loads when it has to generate code.
#pragma once

#include "compiler/mechanics/hybrid_system.h"
#include "runtime/abi/tf_model.h"

#include <memory>
#include <string>

namespace tf {

enum class EmitKind : std::uint8_t { LlvmIr, Assembly, Object, SharedLibrary };

struct CodegenOptions {
  int optimization = 2;  // 0…3
  std::string hash;      // content hash, stored in the model
};

// A model in memory; the code lives as long as this.
class CompiledInMemory {
public:
  virtual ~CompiledInMemory() = default;
  [[nodiscard]] virtual const tf_model *model() const = 0;
};

// Throws std::runtime_error with a message for the user if the machine cannot do it (no memory, unwritable file).
class CodeGenerator {
public:
  virtual ~CodeGenerator() = default;
  virtual std::unique_ptr<CompiledInMemory> compileInMemory(HybridSystem &system, const SourceManager &sources,
                                                            const CodegenOptions &options) = 0;
  // The text or the bytes of the file.
  virtual std::string emit(HybridSystem &system, const SourceManager &sources, EmitKind kind, const CodegenOptions &options) = 0;
  // "cpu features LLVM-version": part of the cache's key.
  [[nodiscard]] virtual std::string target() const = 0;
};

}  // namespace tf

extern "C" tf::CodeGenerator *tf_make_code_generator();
