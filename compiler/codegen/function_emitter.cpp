#include "compiler/codegen/function_emitter.h"

#include "compiler/codegen/expression_emitter.h"
#include "compiler/codegen/sweep_emitter.h"

#include <llvm/IR/IRBuilder.h>

#include <algorithm>
#include <cassert>
#include <map>
#include <unordered_set>
#include <utility>

namespace tf::codegen {

namespace {

// A function of pointers: `in`, `out`, and what else it needs of `mask`, `slots` and `frame`.
llvm::Function *createFunction(llvm::Module &module, const llvm::Twine &name, llvm::ArrayRef<llvm::StringRef> arguments) {
  llvm::LLVMContext &context = module.getContext();
  const llvm::SmallVector<llvm::Type *, 4> types(arguments.size(), llvm::PointerType::getUnqual(context));
  auto *function = llvm::Function::Create(llvm::FunctionType::get(llvm::Type::getVoidTy(context), types, false),
                                          llvm::Function::InternalLinkage, name, module);
  function->setDoesNotThrow();
  function->setWillReturn();
  function->addFnAttr(llvm::Attribute::NoFree);
  function->addFnAttr(llvm::Attribute::NoSync);
  function->addFnAttr(llvm::Attribute::NoRecurse);
  function->addFnAttr("tune-cpu", "generic");  // some processors' models schedule twice, at a sixth of the compile time and without effect
  for (unsigned k = 0; k < types.size(); ++k) {
    llvm::Argument *argument = function->getArg(k);
    argument->setName(arguments[k]);
    argument->addAttr(llvm::Attribute::NoAlias);
    argument->addAttr(llvm::Attribute::NoCapture);
    if (arguments[k] != "slots" && arguments[k] != "frame")
      argument->addAttr(llvm::Attribute::ReadOnly);
    if (arguments[k] != "mask") {
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
  void setFrame(llvm::Value *frame, const ir::Sweep &sweep) {
    expressions_.setFrame(frame);
    firstResultRow_ = firstResultRow(sweep);
    firstSlotRow_ = firstSlotRow(sweep);
  }

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
      case Step::Kind::Result:
        fetch(step.node);
        builder_.CreateAlignedStore(expressions_.number(step.node), expressions_.rowAddress(firstResultRow_ + step.position),
                                    ExpressionEmitter::rowAlignment());
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
    if (const Slot slot = plan_.slotOf(id); slot.index >= 0)
      builder_.CreateAlignedStore(expressions_.number(id), slotAddress(slot), alignmentOf(slot));
    fetched_.insert(id);
  }

  // A value from an earlier unit. No unit writes to a slot that it reads.
  void fetch(ir::NodeId id) {
    if (graph_[id].arity == 0 || !fetched_.insert(id).second)
      return;
    const Slot slot = plan_.slotOf(id);
    assert(slot.index >= 0 && "a value from another unit has a slot");
    llvm::Type *type = slot.isSwept ? expressions_.rowType() : builder_.getDoubleTy();
    expressions_.define(id, expressions_.invariantLoad(type, slotAddress(slot), ""));
  }

  llvm::Value *slotAddress(Slot slot) {
    if (slot.isSwept)
      return expressions_.rowAddress(firstSlotRow_ + slot.index);
    return builder_.CreateConstInBoundsGEP1_32(builder_.getDoubleTy(), slots_, static_cast<unsigned>(slot.index));
  }

  static llvm::Align alignmentOf(Slot slot) { return slot.isSwept ? ExpressionEmitter::rowAlignment() : llvm::Align(8); }

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
  int firstResultRow_ = 0, firstSlotRow_ = 0;
  std::map<int, llvm::Value *> buffers_, outerBuffers_;
  std::unordered_set<ir::NodeId> fetched_;
};

// A unit of a split plan as a function of its own.
llvm::Function *emitPiece(const ir::Function &function, const ir::Graph &graph, const CodePlan &plan, std::size_t index,
                          llvm::Module &module) {
  const Unit &unit = plan.units[index];
  llvm::SmallVector<llvm::StringRef, 4> arguments{"in", "out", "slots"};
  if (unit.isSwept)
    arguments.push_back("frame");
  llvm::Function *piece = createFunction(module, function.name + "." + llvm::Twine(index), arguments);
  piece->addFnAttr(llvm::Attribute::NoInline);
  UnitEmitter emitter(graph, plan, piece);
  emitter.setSlots(piece->getArg(2));
  if (unit.isSwept)
    emitter.setFrame(piece->getArg(3), *function.sweep);
  emitter.emit(unit);
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

// The function that the others are pieces of.
class WholeEmitter {
public:
  WholeEmitter(const ir::Function &function, const ir::Graph &graph, const CodePlan &plan, llvm::Module &module)
      : function_(function), graph_(graph), plan_(plan), module_(module),
        target_(createFunction(module, function.name, {"in", "out", "mask"})), units_(graph, plan, target_), builder_(units_.builder()) {}

  llvm::Function *run() {
    llvm::Type *number = builder_.getDoubleTy();
    if (plan_.isSplit)
      slots_ = builder_.CreateAlloca(llvm::ArrayType::get(number, static_cast<std::uint64_t>(plan_.slotCount)), nullptr, "slots");
    const auto isSwept = [](const Unit &unit) { return unit.isSwept; };
    const auto loop = static_cast<std::size_t>(std::ranges::find_if(plan_.units, isSwept) - plan_.units.begin());
    if (function_.sweep) {
      llvm::Type *row = llvm::FixedVectorType::get(number, sweepLanes);
      const int rows = firstSlotRow(*function_.sweep) + plan_.sweptSlotCount;
      llvm::AllocaInst *frame = builder_.CreateAlloca(llvm::ArrayType::get(row, static_cast<std::uint64_t>(rows)), nullptr, "frame");
      frame->setAlignment(ExpressionEmitter::rowAlignment());
      frame_ = frame;
    }
    emit(0, loop);
    if (function_.sweep)
      emitSweep(*function_.sweep, function_.name, {builder_, target_->getArg(1), target_->getArg(2), frame_},
                [&] { emit(loop, plan_.units.size()); });
    builder_.CreateRetVoid();
    return target_;
  }

private:
  // Units from `first` up to `last`, those of a group under its guard.
  void emit(std::size_t first, std::size_t last) {
    while (first < last) {
      const int group = plan_.units[first].group;
      const std::size_t begin = first;
      while (first < last && plan_.units[first].group == group)
        ++first;
      const auto body = [&] {
        for (std::size_t index = begin; index < first; ++index)
          emitUnit(index);
      };
      if (group < 0) {
        body();
        continue;
      }
      units_.openScope();
      guarded(builder_, target_, group, body);
      units_.closeScope();
    }
  }

  void emitUnit(std::size_t index) {
    const Unit &unit = plan_.units[index];
    if (!plan_.isSplit) {
      units_.emit(unit);
      return;
    }
    llvm::SmallVector<llvm::Value *, 4> arguments{target_->getArg(0), target_->getArg(1), slots_};
    if (unit.isSwept)
      arguments.push_back(frame_);
    builder_.CreateCall(emitPiece(function_, graph_, plan_, index, module_), arguments);
  }

  const ir::Function &function_;
  const ir::Graph &graph_;
  const CodePlan &plan_;
  llvm::Module &module_;
  llvm::Function *target_;
  UnitEmitter units_;
  llvm::IRBuilder<> &builder_;
  llvm::Value *slots_ = nullptr, *frame_ = nullptr;
};

}  // namespace

llvm::Function *emitFunction(const ir::Function &function, const ir::Graph &graph, const CodePlan &plan, llvm::Module &module) {
  return WholeEmitter(function, graph, plan, module).run();
}

}  // namespace tf::codegen
