#include "compiler/codegen/math_library.h"

#include "compiler/ir/operations.h"

#include <llvm/IR/Attributes.h>
#include <llvm/IR/Function.h>
#include <llvm/Support/Casting.h>

#include <array>
#include <cmath>
#include <cstring>
#include <math.h>

namespace tf::codegen {

namespace {

using Unary = double (*)(double);
using Binary = double (*)(double, double);
using Ternary = double (*)(double, double, double);

template <class Function> LibraryFunction entry(std::string_view name, Function *function) {
  return {name, reinterpret_cast<void *>(function)};
}

}  // namespace

std::string_view libraryName(ir::Op op) {
  switch (op) {
  case ir::Op::Pow:
    return "pow";
  case ir::Op::Exp:
  case ir::Op::Log:
  case ir::Op::Log10:
  case ir::Op::Sin:
  case ir::Op::Cos:
  case ir::Op::Tan:
  case ir::Op::Asin:
  case ir::Op::Acos:
  case ir::Op::Atan:
  case ir::Op::Atan2:
  case ir::Op::Sinh:
  case ir::Op::Cosh:
  case ir::Op::Tanh:
    return ir::functionName(op);
  default:
    return {};
  }
}

llvm::FunctionCallee mathFunction(llvm::Module &module, std::string_view name, std::size_t argumentCount) {
  llvm::Type *number = llvm::Type::getDoubleTy(module.getContext());
  const llvm::SmallVector<llvm::Type *, 2> arguments(argumentCount, number);
  llvm::FunctionCallee callee = module.getOrInsertFunction(llvm::StringRef(name), llvm::FunctionType::get(number, arguments, false));
  auto *function = llvm::cast<llvm::Function>(callee.getCallee());
  function->setDoesNotAccessMemory();  // errno is not looked at
  function->setDoesNotThrow();
  function->setWillReturn();
  function->addFnAttr(llvm::Attribute::NoFree);
  function->addFnAttr(llvm::Attribute::NoSync);
  function->addFnAttr(llvm::Attribute::NonLazyBind);  // called through its table entry, without a stub
  return callee;
}

std::span<const LibraryFunction> libraryFunctions() {
  static const std::array functions{
      entry("pow", static_cast<Binary>(::pow)),
      entry("exp", static_cast<Unary>(::exp)),
      entry("log", static_cast<Unary>(::log)),
      entry("log10", static_cast<Unary>(::log10)),
      entry("sin", static_cast<Unary>(::sin)),
      entry("cos", static_cast<Unary>(::cos)),
      entry("tan", static_cast<Unary>(::tan)),
      entry("asin", static_cast<Unary>(::asin)),
      entry("acos", static_cast<Unary>(::acos)),
      entry("atan", static_cast<Unary>(::atan)),
      entry("atan2", static_cast<Binary>(::atan2)),
      entry("sinh", static_cast<Unary>(::sinh)),
      entry("cosh", static_cast<Unary>(::cosh)),
      entry("tanh", static_cast<Unary>(::tanh)),
      entry("floor", static_cast<Unary>(::floor)),
      entry("ceil", static_cast<Unary>(::ceil)),
      entry("sincos", &::sincos),
      entry("fma", static_cast<Ternary>(::fma)),
      entry("memcpy", &::memcpy),
      entry("memset", &::memset),
  };
  return functions;
}

}  // namespace tf::codegen
