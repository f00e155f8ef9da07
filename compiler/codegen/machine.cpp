#include "compiler/codegen/machine.h"

#include <llvm/ADT/SmallVector.h>
#include <llvm/Analysis/TargetLibraryInfo.h>
#include <llvm/Config/llvm-config.h>
#include <llvm/IR/LegacyPassManager.h>
#include <llvm/IR/PassManager.h>
#include <llvm/MC/TargetRegistry.h>
#include <llvm/Passes/PassBuilder.h>
#include <llvm/Support/TargetSelect.h>
#include <llvm/Support/raw_ostream.h>
#include <llvm/TargetParser/Host.h>
#include <llvm/Transforms/InstCombine/InstCombine.h>
#include <llvm/Transforms/Scalar/EarlyCSE.h>
#include <llvm/Transforms/Scalar/SimplifyCFG.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace tf::codegen {

namespace {

// Sorted, so that the text does not depend on the order of LLVM's hash table.
std::string hostFeatures() {
  std::vector<std::string> features;
  for (const auto &feature : llvm::sys::getHostCPUFeatures())
    features.push_back((feature.second ? "+" : "-") + feature.first().str());
  std::sort(features.begin(), features.end());
  std::string text;
  for (const std::string &feature : features)
    text += (text.empty() ? "" : ",") + feature;
  return text;
}

llvm::CodeGenOptLevel codegenLevel(int optimization) {
  switch (optimization) {
  case 0:
    return llvm::CodeGenOptLevel::None;
  case 1:
    return llvm::CodeGenOptLevel::Less;
  case 2:
    return llvm::CodeGenOptLevel::Default;
  default:
    return llvm::CodeGenOptLevel::Aggressive;
  }
}

// The graph is already free of common subexpressions and folded: what is left to LLVM is the cleaning of conditions and loads. Level 3 adds
// the usual simplification of functions, which finds little. No pass may look across functions: loads from slots are invariant within one
// only.
llvm::ModulePassManager pipeline(llvm::PassBuilder &builder, int optimization) {
  llvm::FunctionPassManager passes;
  passes.addPass(llvm::EarlyCSEPass());
  passes.addPass(llvm::InstCombinePass());
  passes.addPass(llvm::SimplifyCFGPass());
  if (optimization >= 3)
    passes.addPass(builder.buildFunctionSimplificationPipeline(llvm::OptimizationLevel::O2, llvm::ThinOrFullLTOPhase::None));
  llvm::ModulePassManager modulePasses;
  modulePasses.addPass(llvm::createModuleToFunctionPassAdaptor(std::move(passes)));
  return modulePasses;
}

}  // namespace

std::unique_ptr<llvm::TargetMachine> hostMachine(int optimization) {
  static const bool initialized = [] {
    llvm::InitializeNativeTarget();
    llvm::InitializeNativeTargetAsmPrinter();
    return true;
  }();
  static_cast<void>(initialized);
  const std::string triple = llvm::sys::getProcessTriple();
  std::string error;
  const llvm::Target *target = llvm::TargetRegistry::lookupTarget(triple, error);
  if (target == nullptr)
    throw std::runtime_error("code generation: LLVM has no target '" + triple + "': " + error);
  llvm::TargetOptions options;
  options.AllowFPOpFusion = llvm::FPOpFusion::Strict;
  std::unique_ptr<llvm::TargetMachine> machine(target->createTargetMachine(triple, llvm::sys::getHostCPUName(), hostFeatures(), options,
                                                                           llvm::Reloc::PIC_, std::nullopt, codegenLevel(optimization)));
  if (machine == nullptr)
    throw std::runtime_error("code generation: LLVM cannot generate code for '" + triple + "'");
  if (optimization == 1)
    machine->setFastISel(true);  // selection of instructions is half of the compile time
  return machine;
}

std::string hostDescription() { return llvm::sys::getHostCPUName().str() + ' ' + hostFeatures() + " LLVM-" LLVM_VERSION_STRING; }

void optimize(llvm::Module &module, llvm::TargetMachine &machine, int optimization) {
  if (optimization <= 0)
    return;
  llvm::PassBuilder builder(&machine);
  llvm::LoopAnalysisManager loops;
  llvm::FunctionAnalysisManager functions;
  llvm::CGSCCAnalysisManager components;
  llvm::ModuleAnalysisManager modules;
  builder.registerModuleAnalyses(modules);
  builder.registerCGSCCAnalyses(components);
  builder.registerFunctionAnalyses(functions);
  builder.registerLoopAnalyses(loops);
  builder.crossRegisterProxies(loops, functions, components, modules);
  pipeline(builder, optimization).run(module, modules);
}

std::string translate(llvm::Module &module, llvm::TargetMachine &machine, llvm::CodeGenFileType type) {
  llvm::SmallVector<char, 0> bytes;
  llvm::raw_svector_ostream stream(bytes);
  llvm::legacy::PassManager passes;
  passes.add(new llvm::TargetLibraryInfoWrapperPass(machine.getTargetTriple()));
  if (machine.addPassesToEmitFile(passes, stream, nullptr, type))
    throw std::runtime_error("code generation: LLVM's target cannot write this kind of file");
  passes.run(module);
  return {bytes.begin(), bytes.end()};
}

}  // namespace tf::codegen
