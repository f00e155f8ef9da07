#include "compiler/codegen/in_memory.h"

#include "compiler/codegen/math_library.h"

#include <llvm/ExecutionEngine/Orc/LLJIT.h>
#include <llvm/Support/MemoryBuffer.h>

#include <stdexcept>

namespace tf::codegen {

namespace {

using namespace llvm::orc;

void check(llvm::Error error) {
  if (error)
    throw std::runtime_error("loading the generated code failed: " + llvm::toString(std::move(error)));
}

template <class T> T value(llvm::Expected<T> expected) {
  check(expected.takeError());
  return std::move(*expected);
}

class InMemory final : public CompiledInMemory {
public:
  explicit InMemory(const std::string &object)
      : jit_(value(LLJITBuilder().setPlatformSetUp(setUpInactivePlatform).setLinkProcessSymbolsByDefault(false).create())) {
    SymbolMap symbols;
    for (const LibraryFunction &function : libraryFunctions())
      symbols[jit_->mangleAndIntern(function.name)] = {ExecutorAddr::fromPtr(function.address),
                                                       llvm::JITSymbolFlags::Exported | llvm::JITSymbolFlags::Callable};
    check(jit_->getMainJITDylib().define(absoluteSymbols(std::move(symbols))));
    check(jit_->addObjectFile(llvm::MemoryBuffer::getMemBufferCopy(object, "model")));
    model_ = value(jit_->lookup(TF_MODEL_SYMBOL)).toPtr<const tf_model *>();
  }

  [[nodiscard]] const tf_model *model() const override { return model_; }

private:
  std::unique_ptr<LLJIT> jit_;
  const tf_model *model_ = nullptr;
};

}  // namespace

std::unique_ptr<CompiledInMemory> loadObject(const std::string &object) { return std::make_unique<InMemory>(object); }

}  // namespace tf::codegen
