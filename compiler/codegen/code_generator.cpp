// The entry point of libtfcodegen.
#include "compiler/codegen/codegen.h"
#include "compiler/codegen/compiled_model.h"

namespace tf {

namespace {

class LlvmCodeGenerator final : public CodeGenerator {
public:
  std::unique_ptr<CompiledInMemory> compileInMemory(HybridSystem &system, const SourceManager &sources,
                                                    const CodegenOptions &options) override {
    const std::vector<ir::Function> functions = modelFunctions(system);
    return codegen::compileInMemory({system, functions, sources}, options);
  }

  std::string emit(HybridSystem &system, const SourceManager &sources, EmitKind kind, const CodegenOptions &options) override {
    const std::vector<ir::Function> functions = modelFunctions(system);
    return codegen::emit({system, functions, sources}, kind, options);
  }

  [[nodiscard]] std::string target() const override { return codegen::hostDescription(); }
};

}  // namespace

}  // namespace tf

extern "C" __attribute__((visibility("default"))) tf::CodeGenerator *tf_make_code_generator() { return new tf::LlvmCodeGenerator; }
