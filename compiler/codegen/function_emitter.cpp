#include "compiler/codegen/function_emitter.h"

#include "compiler/codegen/expression_emitter.h"

#include <llvm/IR/IRBuilder.h>

#include <cassert>
#include <map>
#include <unordered_set>
#include <utility>

namespace tf::codegen {

namespace {

llvm::Function *createFunction(llvm::Module &module, const llvm::Twine &name, bool hasMask, bool hasSlots) {
  llvm::LLVMContext &context = module.getContext();
  llvm::Type *pointer = llvm::PointerType::getUnqual(context);
  llvm::SmallVector<llvm::Type *, 4> types{pointer, pointer};
  if (hasMask)
    types.push_back(pointer);
  if (hasSlots)
    types.push_back(pointer);
  auto *function = llvm::Function::Create(llvm::FunctionType::get(llvm::Type::getVoidTy(context), types, false),
                                          llvm::Function::InternalLinkage, name, module);
  function->setDoesNotThrow();
  function->setWillReturn();
  function->addFnAttr(llvm::Attribute::NoFree);
  function->addFnAttr(llvm::Attribute::NoSync);
  function->addFnAttr(llvm::Attribute::NoRecurse);
  function->addFnAttr("tune-cpu", "generic");  // some processors' models schedule twice, at a sixth of the compile time and without effect
  const char *const names[] = {"in", "out", hasMask ? "mask" : "slots", "slots"};
  for (unsigned k = 0; k < types.size(); ++k) {
    llvm::Argument *argument = function->getArg(k);
    argument->setName(names[k]);
    argument->addAttr(llvm::Attribute::NoAlias);
    argument->addAttr(llvm::Attribute::NoCapture);
    if (argument->getName() != "slots")
      argument->addAttr(llvm::Attribute::ReadOnly);
    if (argument->getName() != "mask") {
      argument->addAttr(llvm::Attribute::NonNull);
      argument->addAttr(llvm::Attribute::NoUndef);
    }
  }
  return function;
}

// The steps of units within one LLVM function.
class UnitEmitter {
public:
  UnitEmitter(const ir::Graph &graph, const CodePlan &plan, llvm::Function *target)
      : graph_(graph), plan_(plan), builder_(llvm::BasicBlock::Create(target->getContext(), "entry", target)),
        expressions_(graph, builder_, target->getArg(0)), outputs_(target->getArg(1)) {}

  llvm::IRBuilder<> &builder() { return builder_; }
  void setSlots(llvm::Value *slots) { slots_ = slots; }

  void openScope() {
    expressions_.openScope();
    outerBuffers_ = buffers_;
  }
  void closeScope() {
    expressions_.closeScope();
    buffers_ = outerBuffers_;
  }

  void emit(const Unit &unit) {
    for (const Step &step : unit.steps) {
      switch (step.kind) {
      case Step::Kind::Evaluate:
        evaluate(step.node);
        break;
      case Step::Kind::Store:
        if (plan_.isSplit)
          fetch(step.node);
        builder_.CreateAlignedStore(expressions_.number(step.node), address(step), llvm::Align(8));
        break;
      case Step::Kind::Clear:
        builder_.CreateMemSet(address(step), builder_.getInt8(0), static_cast<std::uint64_t>(step.length) * sizeof(double), llvm::Align(8));
        break;
      }
    }
  }

private:
  void evaluate(ir::NodeId id) {
    const ir::Node &node = graph_[id];
    if (plan_.isSplit)
      for (int k = 0; k < node.arity; ++k)
        fetch(node.operands[k]);
    expressions_.evaluate(id);
    if (const int slot = plan_.slotOf(id); slot >= 0)
      builder_.CreateAlignedStore(expressions_.number(id), slotAddress(slot), llvm::Align(8));
    fetched_.insert(id);
  }

  // A value from an earlier unit. No unit writes to a slot that it reads.
  void fetch(ir::NodeId id) {
    if (graph_[id].arity == 0 || !fetched_.insert(id).second)
      return;
    const int slot = plan_.slotOf(id);
    assert(slot >= 0 && "a value from another unit has a slot");
    expressions_.define(id, expressions_.invariantLoad(builder_.getDoubleTy(), slotAddress(slot), ""));
  }

  llvm::Value *slotAddress(int slot) {
    return builder_.CreateConstInBoundsGEP1_32(builder_.getDoubleTy(), slots_, static_cast<unsigned>(slot));
  }

  llvm::Value *address(const Step &step) {
    llvm::Value *&buffer = buffers_[step.buffer];
    if (buffer == nullptr) {
      llvm::Value *slot = builder_.CreateConstInBoundsGEP1_32(builder_.getPtrTy(), outputs_, static_cast<unsigned>(step.buffer));
      buffer = expressions_.invariantLoad(builder_.getPtrTy(), slot, "out" + llvm::Twine(step.buffer));
    }
    return builder_.CreateConstInBoundsGEP1_32(builder_.getDoubleTy(), buffer, static_cast<unsigned>(step.position));
  }

  const ir::Graph &graph_;
  const CodePlan &plan_;
  llvm::IRBuilder<> builder_;
  ExpressionEmitter expressions_;
  llvm::Value *outputs_;
  llvm::Value *slots_ = nullptr;
  std::map<int, llvm::Value *> buffers_, outerBuffers_;
  std::unordered_set<ir::NodeId> fetched_;
};

// A unit of a split plan as a function of its own.
llvm::Function *emitPiece(const ir::Function &function, const ir::Graph &graph, const CodePlan &plan, std::size_t index,
                          llvm::Module &module) {
  llvm::Function *piece = createFunction(module, function.name + "." + llvm::Twine(index), false, true);
  piece->addFnAttr(llvm::Attribute::NoInline);
  UnitEmitter emitter(graph, plan, piece);
  emitter.setSlots(piece->getArg(2));
  emitter.emit(plan.units[index]);
  emitter.builder().CreateRetVoid();
  return piece;
}

// Emits `body` under `if (mask[group])`.
template <class Body> void guarded(llvm::IRBuilder<> &builder, llvm::Function *target, int group, const Body &body) {
  llvm::LLVMContext &context = builder.getContext();
  llvm::BasicBlock *taken = llvm::BasicBlock::Create(context, "group" + llvm::Twine(group), target);
  llvm::BasicBlock *next = llvm::BasicBlock::Create(context, "after" + llvm::Twine(group), target);
  llvm::Value *address = builder.CreateConstInBoundsGEP1_32(builder.getInt8Ty(), target->getArg(2), static_cast<unsigned>(group));
  builder.CreateCondBr(builder.CreateIsNotNull(builder.CreateLoad(builder.getInt8Ty(), address)), taken, next);
  builder.SetInsertPoint(taken);
  body();
  builder.CreateBr(next);
  builder.SetInsertPoint(next);
}

}  // namespace

llvm::Function *emitFunction(const ir::Function &function, const ir::Graph &graph, const CodePlan &plan, llvm::Module &module) {
  llvm::Function *target = createFunction(module, function.name, true, false);
  UnitEmitter emitter(graph, plan, target);
  llvm::IRBuilder<> &builder = emitter.builder();
  llvm::Value *slots = nullptr;
  if (plan.isSplit)
    slots = builder.CreateAlloca(llvm::ArrayType::get(builder.getDoubleTy(), static_cast<std::uint64_t>(plan.slotCount)), nullptr, "slots");
  const auto emitUnit = [&](std::size_t index) {
    if (plan.isSplit)
      builder.CreateCall(emitPiece(function, graph, plan, index, module), {target->getArg(0), target->getArg(1), slots});
    else
      emitter.emit(plan.units[index]);
  };
  for (std::size_t first = 0; first < plan.units.size();) {
    const int group = plan.units[first].group;
    std::size_t last = first;
    while (last < plan.units.size() && plan.units[last].group == group)
      ++last;
    const auto body = [&] {
      for (std::size_t index = first; index < last; ++index)
        emitUnit(index);
    };
    if (group < 0) {
      body();
    } else {
      emitter.openScope();
      guarded(builder, target, group, body);
      emitter.closeScope();
    }
    first = last;
  }
  builder.CreateRetVoid();
  return target;
}

}  // namespace tf::codegen
