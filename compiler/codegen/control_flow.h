// Loops, conditions and tables in LLVM.
#pragma once

#include <llvm/IR/Constants.h>
#include <llvm/IR/IRBuilder.h>
#include <llvm/IR/Module.h>

#include <functional>
#include <string>

namespace tf::codegen {

// for (k = begin; k < end; ++k) body(k), of i32.
void countedLoop(llvm::IRBuilder<> &builder, llvm::Value *begin, llvm::Value *end, const std::function<void(llvm::Value *)> &body);

// The same, where body(k) returns the step to the next k.
void steppingLoop(llvm::IRBuilder<> &builder, llvm::Value *begin, llvm::Value *end,
                  const std::function<llvm::Value *(llvm::Value *)> &body);

// if (condition) body()
void whereTrue(llvm::IRBuilder<> &builder, llvm::Value *condition, const std::function<void()> &body);

// if (condition) yes() else no()
void chooseByTruth(llvm::IRBuilder<> &builder, llvm::Value *condition, const std::function<void()> &yes, const std::function<void()> &no);

// A constant array of the module.
template <class Number> llvm::Constant *constantTable(llvm::Module &module, const std::string &name, llvm::ArrayRef<Number> numbers) {
  llvm::Constant *values = llvm::ConstantDataArray::get(module.getContext(), numbers);
  auto *variable = new llvm::GlobalVariable(module, values->getType(), true, llvm::GlobalValue::PrivateLinkage, values, name);
  variable->setUnnamedAddr(llvm::GlobalValue::UnnamedAddr::Global);
  return variable;
}

}  // namespace tf::codegen
