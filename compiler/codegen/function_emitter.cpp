#include "compiler/codegen/function_emitter.h"

#include "compiler/codegen/control_flow.h"
#include "compiler/codegen/expression_emitter.h"
#include "compiler/codegen/sweep_emitter.h"

#include <llvm/IR/IRBuilder.h>

#include <algorithm>
#include <cassert>
#include <functional>
#include <map>
#include <string>
#include <unordered_map>
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

  // What units of a repetition differ in comes from a row of its tables.
  void setRow(const LoopTables &tables, llvm::Value *wholes, llvm::Value *reals) {
    for (std::size_t k = 0; k < tables.places.size(); ++k) {
      const Place &place = tables.places[k];
      if (place.kind == Place::Kind::Constant) {
        if (const RealSource source = tables.reals[k]; source.column >= 0)
          expressions_.replace(place.node, readRow(builder_.getDoubleTy(), reals, source.column));
        continue;
      }
      const WholeSource source = tables.wholes[k];
      if (source.column < 0 && place.kind == Place::Kind::Symbol)
        continue;
      llvm::Value *number = wholeNumber(source, wholes);
      switch (place.kind) {
      case Place::Kind::Symbol:
        expressions_.replace(place.node, expressions_.load(graph_[place.node].symbol, number));
        break;
      case Place::Kind::Slot:
        slotNumbers_[place.node] = number;
        break;
      case Place::Kind::Position:
        positions_[place.step] = number;
        break;
      default:
        lengths_[place.step] = number;
      }
    }
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
    for (std::size_t k = 0; k < unit.steps.size(); ++k) {
      const Step &step = unit.steps[k];
      const int number = static_cast<int>(k);
      switch (step.kind) {
      case Step::Kind::Evaluate:
        evaluate(step.node);
        break;
      case Step::Kind::Store:
        if (plan_.isSplit)
          fetch(step.node);
        builder_.CreateAlignedStore(expressions_.number(step.node), address(step, number), llvm::Align(8));
        break;
      case Step::Kind::Add: {
        if (plan_.isSplit)
          fetch(step.node);
        llvm::Value *place = address(step, number);
        llvm::Value *before = builder_.CreateAlignedLoad(builder_.getDoubleTy(), place, llvm::Align(8));
        builder_.CreateAlignedStore(builder_.CreateFAdd(before, expressions_.number(step.node)), place, llvm::Align(8));
        break;
      }
      case Step::Kind::Result:
        fetch(step.node);
        builder_.CreateAlignedStore(expressions_.number(step.node), row(positionOf(step, number), firstResultRow_),
                                    ExpressionEmitter::rowAlignment());
        break;
      case Step::Kind::Clear:
        builder_.CreateMemSet(address(step, number), builder_.getInt8(0),
                              builder_.CreateNSWMul(lengthOf(step, number), builder_.getInt64(sizeof(double))), llvm::Align(8));
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
      builder_.CreateAlignedStore(expressions_.number(id), slotAddress(id, slot), alignmentOf(slot));
    fetched_.insert(id);
  }

  // A value from an earlier unit. No unit writes to a slot that it reads.
  void fetch(ir::NodeId id) {
    if (graph_[id].arity == 0 || !fetched_.insert(id).second)
      return;
    const Slot slot = plan_.slotOf(id);
    assert(slot.index >= 0 && "a value from another unit has a slot");
    llvm::Type *type = slot.isSwept ? expressions_.rowType() : builder_.getDoubleTy();
    expressions_.define(id, expressions_.invariantLoad(type, slotAddress(id, slot), ""));
  }

  llvm::Value *slotAddress(ir::NodeId id, Slot slot) {
    const auto found = slotNumbers_.find(id);
    llvm::Value *number = found != slotNumbers_.end() ? found->second : builder_.getInt64(static_cast<std::uint64_t>(slot.index));
    if (slot.isSwept)
      return row(number, firstSlotRow_);
    return builder_.CreateInBoundsGEP(builder_.getDoubleTy(), slots_, number);
  }

  static llvm::Align alignmentOf(Slot slot) { return slot.isSwept ? ExpressionEmitter::rowAlignment() : llvm::Align(8); }

  // Row `number` of the frame's rows from `first` on.
  llvm::Value *row(llvm::Value *number, int first) {
    return builder_.CreateInBoundsGEP(expressions_.rowType(), expressions_.rowAddress(first), number);
  }

  llvm::Value *address(const Step &step, int number) {
    llvm::Value *&buffer = buffers_[step.buffer];
    if (buffer == nullptr) {
      llvm::Value *slot = builder_.CreateConstInBoundsGEP1_32(builder_.getPtrTy(), outputs_, static_cast<unsigned>(step.buffer));
      buffer = expressions_.invariantLoad(builder_.getPtrTy(), slot, "out" + llvm::Twine(step.buffer));
    }
    return builder_.CreateInBoundsGEP(builder_.getDoubleTy(), buffer, positionOf(step, number));
  }

  llvm::Value *positionOf(const Step &step, int number) { return numberOf(positions_, number, step.position); }
  llvm::Value *lengthOf(const Step &step, int number) { return numberOf(lengths_, number, step.length); }
  llvm::Value *numberOf(const std::map<int, llvm::Value *> &tabulated, int step, int own) {
    const auto found = tabulated.find(step);
    return found != tabulated.end() ? found->second : builder_.getInt64(static_cast<std::uint64_t>(own));
  }

  llvm::Value *wholeNumber(WholeSource source, llvm::Value *wholes) {
    llvm::Value *offset = builder_.getInt64(static_cast<std::uint64_t>(source.offset));
    if (source.column < 0)
      return offset;
    llvm::Value *entry = builder_.CreateSExt(readRow(builder_.getInt32Ty(), wholes, source.column), builder_.getInt64Ty());
    return source.offset == 0 ? entry : builder_.CreateNSWAdd(entry, offset);
  }

  llvm::Value *readRow(llvm::Type *type, llvm::Value *tableRow, int column) {
    llvm::Value *place = builder_.CreateConstInBoundsGEP1_32(type, tableRow, static_cast<unsigned>(column));
    llvm::LoadInst *load = builder_.CreateLoad(type, place);
    load->setMetadata(llvm::LLVMContext::MD_invariant_load, llvm::MDNode::get(builder_.getContext(), {}));
    return load;
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
  // Of a repetition: slots of nodes, positions and lengths of steps.
  std::unordered_map<ir::NodeId, llvm::Value *> slotNumbers_;
  std::map<int, llvm::Value *> positions_, lengths_;
};

// A unit of a split plan as a function of its own; those of a repetition (`tables` is not null) as one function of a row of its tables.
llvm::Function *emitPiece(const ir::Function &function, const ir::Graph &graph, const CodePlan &plan, std::size_t index,
                          const LoopTables *tables, llvm::Module &module) {
  const Unit &unit = plan.units[index];
  llvm::SmallVector<llvm::StringRef, 6> arguments{"in", "out", "slots"};
  if (tables != nullptr)
    arguments.append({"wholes", "reals"});
  if (unit.isSwept)
    arguments.push_back("frame");
  llvm::Function *piece = createFunction(module, function.name + "." + llvm::Twine(index), arguments);
  piece->addFnAttr(llvm::Attribute::NoInline);
  UnitEmitter emitter(graph, plan, piece);
  emitter.setSlots(piece->getArg(2));
  if (unit.isSwept)
    emitter.setFrame(piece->getArg(static_cast<unsigned>(arguments.size()) - 1), *function.sweep);
  if (tables != nullptr)
    emitter.setRow(*tables, piece->getArg(3), piece->getArg(4));
  emitter.emit(unit);
  emitter.builder().CreateRetVoid();
  return piece;
}

// Whether a group is selected, or either of two.
llvm::Value *isSelected(llvm::IRBuilder<> &builder, llvm::Value *mask, llvm::Value *group, llvm::Value *second) {
  const auto flag = [&](llvm::Value *number) {
    return builder.CreateLoad(builder.getInt8Ty(), builder.CreateInBoundsGEP(builder.getInt8Ty(), mask, number));
  };
  llvm::Value *flags = flag(group);
  if (second != nullptr)
    flags = builder.CreateOr(flags, flag(second));
  return builder.CreateIsNotNull(flags);
}

// Emits `body` under the guard of the unit.
template <class Body> void guarded(llvm::IRBuilder<> &builder, llvm::Function *target, const Unit &unit, const Body &body) {
  llvm::LLVMContext &context = builder.getContext();
  llvm::BasicBlock *taken = llvm::BasicBlock::Create(context, "group" + llvm::Twine(unit.group), target);
  llvm::BasicBlock *next = llvm::BasicBlock::Create(context, "after" + llvm::Twine(unit.group), target);
  const auto number = [&builder](int group) { return builder.getInt32(static_cast<std::uint32_t>(group)); };
  llvm::Value *selected = isSelected(builder, target->getArg(2), number(unit.group), unit.second < 0 ? nullptr : number(unit.second));
  builder.CreateCondBr(selected, taken, next);
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
    const std::size_t afterLoop = loop + static_cast<std::size_t>(std::ranges::count_if(plan_.units, isSwept));
    if (function_.sweep) {
      llvm::Type *row = llvm::FixedVectorType::get(number, sweepLanes);
      const int rows = firstSlotRow(*function_.sweep) + plan_.sweptSlotCount;
      llvm::AllocaInst *frame = builder_.CreateAlloca(llvm::ArrayType::get(row, static_cast<std::uint64_t>(rows)), nullptr, "frame");
      frame->setAlignment(ExpressionEmitter::rowAlignment());
      frame_ = frame;
    }
    const auto isLate = [](const Unit &unit) { return unit.isLate; };
    const auto late = static_cast<std::size_t>(std::ranges::find_if(plan_.units, isLate) - plan_.units.begin());
    emit(0, std::min(loop, late));
    if (function_.sweep)
      emitSweep(*function_.sweep, function_.name, {builder_, target_->getArg(0), target_->getArg(1), target_->getArg(2), frame_},
                [&] { emit(loop, afterLoop); });
    emit(late, plan_.units.size());
    builder_.CreateRetVoid();
    return target_;
  }

private:
  // Units from `first` up to `last`, those of a group under its guard.
  void emit(std::size_t first, std::size_t last) {
    while (first < last) {
      if (const Repetition *repetition = repetitionAt(first); repetition != nullptr) {
        emitLoop(*repetition);
        first += static_cast<std::size_t>(repetition->count);
        continue;
      }
      const Unit &unit = plan_.units[first];
      const std::size_t begin = first;
      const auto isAlike = [&unit](const Unit &other) { return other.group == unit.group && other.second == unit.second; };
      while (first < last && isAlike(plan_.units[first]) && (first == begin || repetitionAt(first) == nullptr))
        ++first;
      const auto body = [&] {
        for (std::size_t index = begin; index < first; ++index)
          emitUnit(index);
      };
      if (unit.group < 0) {
        body();
        continue;
      }
      units_.openScope();
      guarded(builder_, target_, unit, body);
      units_.closeScope();
    }
  }

  [[nodiscard]] const Repetition *repetitionAt(std::size_t unit) const {
    const auto found = std::ranges::lower_bound(plan_.repetitions, static_cast<int>(unit), {}, &Repetition::first);
    return found != plan_.repetitions.end() && found->first == static_cast<int>(unit) ? &*found : nullptr;
  }

  void emitLoop(const Repetition &repetition) {
    const auto index = static_cast<std::size_t>(repetition.first);
    const Unit &unit = plan_.units[index];
    const LoopTables &tables = repetition.tables;
    llvm::Function *piece = emitPiece(function_, graph_, plan_, index, &tables, module_);
    const std::string name = function_.name + "." + std::to_string(index);
    llvm::Constant *wholes = constantTable(module_, name + ".wholes", llvm::ArrayRef<std::int32_t>(tables.wholeRows));
    llvm::Constant *reals = constantTable(module_, name + ".reals", llvm::ArrayRef<double>(tables.realRows));
    const auto rowOf = [&](llvm::Type *type, llvm::Value *table, int columns, llvm::Value *row) {
      return builder_.CreateInBoundsGEP(type, table, builder_.CreateNSWMul(row, builder_.getInt32(static_cast<std::uint32_t>(columns))));
    };
    const auto runRow = [&](llvm::Value *row) {
      llvm::SmallVector<llvm::Value *, 6> arguments{target_->getArg(0), target_->getArg(1), slots_,
                                                    rowOf(builder_.getInt32Ty(), wholes, tables.wholeColumns, row),
                                                    rowOf(builder_.getDoubleTy(), reals, tables.realColumns, row)};
      if (unit.isSwept)
        arguments.push_back(frame_);
      builder_.CreateCall(piece, arguments);
    };
    llvm::Value *first = builder_.getInt32(0), *count = builder_.getInt32(static_cast<std::uint32_t>(repetition.count));
    if (unit.group < 0)
      return countedLoop(builder_, first, count, runRow);
    const auto entry = [&](const WholeSource &source, llvm::Value *row) -> llvm::Value * {
      llvm::Value *offset = builder_.getInt32(static_cast<std::uint32_t>(source.offset));
      if (source.column < 0)
        return offset;
      llvm::Type *type = builder_.getInt32Ty();
      llvm::Value *place =
          builder_.CreateConstInBoundsGEP1_32(type, rowOf(type, wholes, tables.wholeColumns, row), static_cast<unsigned>(source.column));
      return builder_.CreateNSWAdd(builder_.CreateLoad(type, place), offset);
    };
    steppingLoop(builder_, first, count, [&](llvm::Value *row) {
      llvm::SmallVector<llvm::Value *, 2> groups{entry(tables.group, row)};
      if (unit.second >= 0)
        groups.push_back(entry(tables.second, row));
      const auto guardedRow = [&] {
        whereTrue(builder_, isSelected(builder_, target_->getArg(2), groups[0], groups.size() > 1 ? groups[1] : nullptr),
                  [&] { runRow(row); });
      };
      return skipping(groups, [&](std::size_t width) { return entry(tables.skips[width], row); }, guardedRow);
    });
  }

  // Of few groups that are selected among many, flags are read several at a time. Returns by how many rows to go on, after body() or where
  // all of flagWidths[w] flags from each of the groups on are zero: then skip(w).
  llvm::Value *skipping(llvm::ArrayRef<llvm::Value *> groups, const std::function<llvm::Value *(std::size_t)> &skip,
                        const std::function<void()> &body) {
    const auto block = [&](const char *name) { return llvm::BasicBlock::Create(builder_.getContext(), name, target_); };
    llvm::BasicBlock *joined = block("joined");
    llvm::SmallVector<std::pair<llvm::Value *, llvm::BasicBlock *>, 3> steps;
    for (std::size_t w = 0; w < flagWidths.size(); ++w) {
      const int width = flagWidths[w];
      if (width > function_.groups)
        continue;
      llvm::BasicBlock *look = block("look"), *zero = block("zero"), *closer = block("closer");
      // The second group is the larger one.
      llvm::Value *last = builder_.getInt32(static_cast<std::uint32_t>(function_.groups - width));
      builder_.CreateCondBr(builder_.CreateICmpSLE(groups.back(), last), look, closer);
      builder_.SetInsertPoint(look);
      llvm::Value *flags = nullptr;
      for (llvm::Value *group : groups) {
        llvm::Value *place = builder_.CreateInBoundsGEP(builder_.getInt8Ty(), target_->getArg(2), group);
        llvm::Value *some = builder_.CreateAlignedLoad(builder_.getIntNTy(8 * static_cast<unsigned>(width)), place, llvm::Align(1));
        flags = flags == nullptr ? some : builder_.CreateOr(flags, some);
      }
      builder_.CreateCondBr(builder_.CreateIsNull(flags), zero, closer);
      builder_.SetInsertPoint(zero);
      steps.emplace_back(skip(w), zero);
      builder_.CreateBr(joined);
      builder_.SetInsertPoint(closer);
    }
    body();
    steps.emplace_back(builder_.getInt32(1), builder_.GetInsertBlock());
    builder_.CreateBr(joined);
    builder_.SetInsertPoint(joined);
    llvm::PHINode *step = builder_.CreatePHI(builder_.getInt32Ty(), static_cast<unsigned>(steps.size()));
    for (const auto &[value, from] : steps)
      step->addIncoming(value, from);
    return step;
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
    builder_.CreateCall(emitPiece(function_, graph_, plan_, index, nullptr, module_), arguments);
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
