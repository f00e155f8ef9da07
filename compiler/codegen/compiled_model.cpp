#include "compiler/codegen/compiled_model.h"

#include "compiler/codegen/in_memory.h"
#include "compiler/codegen/linker.h"
#include "compiler/codegen/machine.h"
#include "compiler/codegen/module_builder.h"

#include <llvm/Support/raw_ostream.h>

namespace tf::codegen {

namespace {

std::string irText(const llvm::Module &module) {
  std::string text;
  llvm::raw_string_ostream stream(text);
  module.print(stream, nullptr);
  return text;
}

}  // namespace

std::string emit(const ModelSource &source, EmitKind kind, const CodegenOptions &options) {
  llvm::LLVMContext context;
  const auto machine = hostMachine(options.optimization);
  const auto module = buildModule(source, options, context, *machine);
  optimize(*module, *machine, options.optimization);
  switch (kind) {
  case EmitKind::LlvmIr:
    return irText(*module);
  case EmitKind::Assembly:
    return translate(*module, *machine, llvm::CodeGenFileType::AssemblyFile);
  case EmitKind::Object:
    return translate(*module, *machine, llvm::CodeGenFileType::ObjectFile);
  case EmitKind::SharedLibrary:
    break;
  }
  return linkShared(translate(*module, *machine, llvm::CodeGenFileType::ObjectFile));
}

std::unique_ptr<CompiledInMemory> compileInMemory(const ModelSource &source, const CodegenOptions &options) {
  return loadObject(emit(source, EmitKind::Object, options));
}

}  // namespace tf::codegen
