#include "compiler/codegen/sweep_emitter.h"

#include "compiler/codegen/control_flow.h"
#include "compiler/codegen/expression_emitter.h"
#include "runtime/abi/tf_model.h"

#include <llvm/IR/Constants.h>
#include <llvm/IR/Module.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

namespace tf::codegen {

namespace {

static_assert(sweepLanes == TF_DIRECTIONS);

// Numbers of a run in the table; `Lane` is that of its colour. It stands for those of the next lanes as well, `Lanes` in all, whose places
// follow one another.
enum RunField : unsigned { First, Lane, Count, Buffer, Position, Stride, Group, Lanes, runFields };

// Seeds and runs of all passes; pass k has those from begin[k] to begin[k + 1]. A seed is an index into the frame as an array of numbers.
struct Tables {
  std::vector<std::int32_t> seeds, seedBegin{0}, runs, runBegin{0}, resultGroups;
};

// How many colours from the first one on have at place `index` the same run, one place further each.
std::size_t lanesOf(std::span<const ir::Sweep::Colour> colours, std::size_t index) {
  const ir::Sweep::Run &first = colours.front().runs[index];
  const auto continues = [&](std::size_t lane) {
    ir::Sweep::Run expected = first;
    expected.position += static_cast<int>(lane);
    return index < colours[lane].runs.size() && colours[lane].runs[index] == expected;
  };
  std::size_t lanes = 1;
  while (lanes < colours.size() && continues(lanes))
    ++lanes;
  return lanes;
}

// The runs of the colours of one pass.
void addRuns(std::span<const ir::Sweep::Colour> colours, std::vector<std::int32_t> &runs) {
  std::vector<std::size_t> covered;  // lanes that runs of lanes before stand for, by place
  for (std::size_t lane = 0; lane < colours.size(); ++lane) {
    covered.resize(std::max(covered.size(), colours[lane].runs.size()), 0);
    for (std::size_t index = 0; index < colours[lane].runs.size(); ++index) {
      if (lane < covered[index])
        continue;
      const ir::Sweep::Run &run = colours[lane].runs[index];
      const std::size_t lanes = lanesOf(colours.subspan(lane), index);
      covered[index] = lane + lanes;
      runs.insert(runs.end(), {run.first, static_cast<std::int32_t>(lane), run.count, run.buffer, run.position, run.stride, run.group,
                               static_cast<std::int32_t>(lanes)});
    }
  }
}

Tables tabulate(const ir::Sweep &sweep) {
  Tables tables;
  for (std::size_t first = 0; first < sweep.colours.size(); first += sweepLanes) {
    const std::size_t last = std::min(first + sweepLanes, sweep.colours.size());
    for (std::size_t c = first; c < last; ++c) {
      const auto lane = static_cast<std::int32_t>(c - first);
      for (const int seed : sweep.colours[c].seeds)
        tables.seeds.push_back(seed * static_cast<std::int32_t>(sweepLanes) + lane);
    }
    addRuns(std::span(sweep.colours).subspan(first, last - first), tables.runs);
    tables.seedBegin.push_back(static_cast<std::int32_t>(tables.seeds.size()));
    tables.runBegin.push_back(static_cast<std::int32_t>(tables.runs.size() / runFields));
  }
  for (const ir::Sweep::Result &result : sweep.results)
    tables.resultGroups.push_back(result.group);
  return tables;
}

// Goes to `yes` where the group is −1 or selected, else to `no`.
void branchOnGroup(llvm::IRBuilder<> &builder, llvm::Value *mask, llvm::Value *group, llvm::BasicBlock *yes, llvm::BasicBlock *no) {
  llvm::BasicBlock *look = llvm::BasicBlock::Create(builder.getContext(), "look", builder.GetInsertBlock()->getParent());
  builder.CreateCondBr(builder.CreateICmpSLT(group, builder.getInt32(0)), yes, look);
  builder.SetInsertPoint(look);
  llvm::Value *selected = builder.CreateLoad(builder.getInt8Ty(), builder.CreateInBoundsGEP(builder.getInt8Ty(), mask, group));
  builder.CreateCondBr(builder.CreateIsNotNull(selected), yes, no);
}

// Emits `body` under the group's guard.
void whereSelected(llvm::IRBuilder<> &builder, llvm::Value *mask, llvm::Value *group, const std::function<void()> &body) {
  llvm::Function *function = builder.GetInsertBlock()->getParent();
  llvm::BasicBlock *yes = llvm::BasicBlock::Create(builder.getContext(), "selected", function);
  llvm::BasicBlock *next = llvm::BasicBlock::Create(builder.getContext(), "next", function);
  branchOnGroup(builder, mask, group, yes, next);
  builder.SetInsertPoint(yes);
  body();
  builder.CreateBr(next);
  builder.SetInsertPoint(next);
}

llvm::Value *element(llvm::IRBuilder<> &builder, llvm::Type *type, llvm::Value *array, llvm::Value *index) {
  return builder.CreateLoad(type, builder.CreateInBoundsGEP(type, array, index));
}

llvm::Value *runField(llvm::IRBuilder<> &builder, llvm::Value *runs, llvm::Value *run, unsigned field) {
  llvm::Value *index = builder.CreateNSWAdd(builder.CreateNSWMul(run, builder.getInt32(runFields)), builder.getInt32(field));
  return element(builder, builder.getInt32Ty(), runs, index);
}

// The functions below are the same for all sweeps of a module.
llvm::Function *helper(llvm::Module &module, const char *name, llvm::Type *result, llvm::ArrayRef<llvm::Type *> arguments) {
  llvm::Function *function =
      llvm::Function::Create(llvm::FunctionType::get(result, arguments, false), llvm::Function::InternalLinkage, name, module);
  function->setDoesNotThrow();
  function->addFnAttr(llvm::Attribute::NoInline);
  return function;
}

// void (ptr frame, ptr seeds, i32 begin, i32 end, double value)
llvm::Function *setSeeds(llvm::Module &module) {
  if (llvm::Function *known = module.getFunction("sweep.set"))
    return known;
  llvm::IRBuilder<> builder(module.getContext());
  llvm::Type *pointer = builder.getPtrTy(), *integer = builder.getInt32Ty(), *number = builder.getDoubleTy();
  llvm::Function *function = helper(module, "sweep.set", builder.getVoidTy(), {pointer, pointer, integer, integer, number});
  builder.SetInsertPoint(llvm::BasicBlock::Create(module.getContext(), "entry", function));
  countedLoop(builder, function->getArg(2), function->getArg(3), [&](llvm::Value *k) {
    llvm::Value *place = element(builder, integer, function->getArg(1), k);
    builder.CreateStore(function->getArg(4), builder.CreateInBoundsGEP(number, function->getArg(0), place));
  });
  builder.CreateRetVoid();
  return function;
}

// i1 (ptr mask, ptr runs, i32 begin, i32 end): whether a run is selected
llvm::Function *isNeeded(llvm::Module &module) {
  if (llvm::Function *known = module.getFunction("sweep.needed"))
    return known;
  llvm::IRBuilder<> builder(module.getContext());
  llvm::Type *pointer = builder.getPtrTy(), *integer = builder.getInt32Ty();
  llvm::Function *function = helper(module, "sweep.needed", builder.getInt1Ty(), {pointer, pointer, integer, integer});
  builder.SetInsertPoint(llvm::BasicBlock::Create(module.getContext(), "entry", function));
  countedLoop(builder, function->getArg(2), function->getArg(3), [&](llvm::Value *k) {
    llvm::Value *group = runField(builder, function->getArg(1), k, Group);
    llvm::BasicBlock *yes = llvm::BasicBlock::Create(module.getContext(), "yes", function);
    llvm::BasicBlock *no = llvm::BasicBlock::Create(module.getContext(), "no", function);
    branchOnGroup(builder, function->getArg(0), group, yes, no);
    builder.SetInsertPoint(yes);
    builder.CreateRet(builder.getTrue());
    builder.SetInsertPoint(no);
  });
  builder.CreateRet(builder.getFalse());
  return function;
}

// Emits `body` for each number of lanes that `lanes` may be, so that vectors of a known width are moved.
void forLanes(llvm::IRBuilder<> &builder, llvm::Value *lanes, const std::function<void(unsigned lanes)> &body) {
  llvm::Function *function = builder.GetInsertBlock()->getParent();
  llvm::BasicBlock *done = llvm::BasicBlock::Create(builder.getContext(), "done", function);
  llvm::SwitchInst *choice = builder.CreateSwitch(lanes, done, sweepLanes);
  for (unsigned count = 1; count <= sweepLanes; ++count) {
    llvm::BasicBlock *block = llvm::BasicBlock::Create(builder.getContext(), "lanes", function);
    choice->addCase(builder.getInt32(count), block);
    builder.SetInsertPoint(block);
    body(count);
    builder.CreateBr(done);
  }
  builder.SetInsertPoint(done);
}

// void (ptr results, ptr runs, i32 begin, i32 end, ptr out, ptr mask, ptr resultGroups); the last one is read only of sweeps whose results
// are in groups.
llvm::Function *storeRuns(llvm::Module &module, bool isGrouped) {
  const char *name = isGrouped ? "sweep.store.selected" : "sweep.store";
  if (llvm::Function *known = module.getFunction(name))
    return known;
  llvm::IRBuilder<> builder(module.getContext());
  llvm::Type *pointer = builder.getPtrTy(), *integer = builder.getInt32Ty(), *number = builder.getDoubleTy();
  llvm::Function *function = helper(module, name, builder.getVoidTy(), {pointer, pointer, integer, integer, pointer, pointer, pointer});
  builder.SetInsertPoint(llvm::BasicBlock::Create(module.getContext(), "entry", function));
  llvm::Value *mask = function->getArg(5);
  countedLoop(builder, function->getArg(2), function->getArg(3), [&](llvm::Value *run) {
    llvm::Value *fields[runFields];
    for (unsigned field = 0; field < runFields; ++field)
      fields[field] = runField(builder, function->getArg(1), run, field);
    whereSelected(builder, mask, fields[Group], [&] {
      llvm::Value *buffer = element(builder, pointer, function->getArg(4), fields[Buffer]);
      llvm::Value *firstPlace = builder.CreateNSWAdd(builder.CreateNSWMul(fields[First], builder.getInt32(sweepLanes)), fields[Lane]);
      llvm::Value *first = builder.CreateInBoundsGEP(number, function->getArg(0), firstPlace);
      llvm::Value *firstTarget = builder.CreateInBoundsGEP(number, buffer, fields[Position]);
      forLanes(builder, fields[Lanes], [&](unsigned lanes) {
        llvm::Type *row = llvm::FixedVectorType::get(number, lanes);
        const llvm::Align alignment(alignof(double));
        countedLoop(builder, builder.getInt32(0), fields[Count], [&](llvm::Value *k) {
          const auto store = [&] {
            llvm::Value *from = builder.CreateInBoundsGEP(number, first, builder.CreateNSWMul(k, builder.getInt32(sweepLanes)));
            llvm::Value *to = builder.CreateInBoundsGEP(number, firstTarget, builder.CreateNSWMul(k, fields[Stride]));
            builder.CreateAlignedStore(builder.CreateAlignedLoad(row, from, alignment), to, alignment);
          };
          if (isGrouped)
            whereSelected(builder, mask, element(builder, integer, function->getArg(6), builder.CreateNSWAdd(fields[First], k)), store);
          else
            store();
        });
      });
    });
  });
  builder.CreateRetVoid();
  return function;
}

}  // namespace

void emitSweep(const ir::Sweep &sweep, const std::string &name, const SweepContext &context, const std::function<void()> &emitBody) {
  llvm::IRBuilder<> &builder = context.builder;
  llvm::Module &module = *builder.GetInsertBlock()->getModule();
  const Tables tables = tabulate(sweep);
  llvm::Constant *seeds = constantTable<std::int32_t>(module, name + ".seeds", tables.seeds),
                 *seedBegin = constantTable<std::int32_t>(module, name + ".seedBegin", tables.seedBegin);
  llvm::Constant *runs = constantTable<std::int32_t>(module, name + ".runs", tables.runs),
                 *runBegin = constantTable<std::int32_t>(module, name + ".runBegin", tables.runBegin);
  llvm::Constant *groups = constantTable<std::int32_t>(module, name + ".resultGroups", tables.resultGroups);
  const bool isGrouped = std::ranges::any_of(tables.resultGroups, [](std::int32_t group) { return group >= 0; });
  const std::uint64_t rowBytes = sweepLanes * sizeof(double);
  llvm::Value *results =
      builder.CreateConstInBoundsGEP1_32(builder.getDoubleTy(), context.frame, static_cast<unsigned>(firstResultRow(sweep)) * sweepLanes);
  llvm::Type *integer = builder.getInt32Ty(), *pointer = builder.getPtrTy();
  llvm::Value *passes = builder.getInt32(static_cast<std::uint32_t>(tables.seedBegin.size() - 1));
  llvm::Value *isGiven = sweep.products < 0 ? builder.getFalse() : builder.CreateIsNotNull(context.mask, "isGiven");
  llvm::Value *count = sweep.products < 0 ? passes : builder.CreateSelect(isGiven, builder.getInt32(1), passes);
  const auto copyRows = [&](llvm::Value *to, llvm::Value *from, std::size_t rows) {
    const llvm::Align alignment(alignof(double));
    builder.CreateMemCpy(to, alignment, from, alignment, rows * rowBytes);
  };
  // Of the caller's directions, or of those of a pass.
  const auto choose = [&](const std::function<void()> &ofCaller, const std::function<void()> &ofPass) {
    if (sweep.products < 0)
      return ofPass();
    chooseByTruth(builder, isGiven, ofCaller, ofPass);
  };
  choose([] {},
         [&] {
           builder.CreateMemSet(context.frame, builder.getInt8(0), static_cast<std::uint64_t>(sweep.seedCount) * rowBytes,
                                llvm::Align(sizeof(double)));
         });
  countedLoop(builder, builder.getInt32(0), count, [&](llvm::Value *pass) {
    llvm::Value *next = builder.CreateNSWAdd(pass, builder.getInt32(1));
    llvm::Value *firstRun = element(builder, integer, runBegin, pass), *lastRun = element(builder, integer, runBegin, next);
    llvm::Value *firstSeed = element(builder, integer, seedBegin, pass), *lastSeed = element(builder, integer, seedBegin, next);
    llvm::Function *function = builder.GetInsertBlock()->getParent();
    llvm::BasicBlock *needed = llvm::BasicBlock::Create(module.getContext(), "needed", function);
    llvm::BasicBlock *done = llvm::BasicBlock::Create(module.getContext(), "done", function);
    builder.CreateCondBr(builder.CreateCall(isNeeded(module), {context.mask, runs, firstRun, lastRun}), needed, done);
    builder.SetInsertPoint(needed);
    const auto set = [&](double value) {
      builder.CreateCall(setSeeds(module),
                         {context.frame, seeds, firstSeed, lastSeed, llvm::ConstantFP::get(builder.getDoubleTy(), value)});
    };
    choose(
        [&] {
          llvm::Value *directions = element(builder, pointer, context.inputs, builder.getInt32(TF_IN_DIRECTIONS));
          copyRows(context.frame, directions, static_cast<std::size_t>(sweep.seedCount));
        },
        [&] { set(1); });
    emitBody();
    choose(
        [&] {
          llvm::Value *products = element(builder, pointer, context.outputs, builder.getInt32(static_cast<std::uint32_t>(sweep.products)));
          copyRows(products, results, sweep.results.size());
        },
        [&] {
          builder.CreateCall(storeRuns(module, isGrouped), {results, runs, firstRun, lastRun, context.outputs, context.mask, groups});
          set(0);
        });
    builder.CreateBr(done);
    builder.SetInsertPoint(done);
  });
}

}  // namespace tf::codegen
