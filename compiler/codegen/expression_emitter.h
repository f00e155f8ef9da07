// LLVM values of expression nodes within one LLVM function.
#pragma once

#include "compiler/ir/function.h"
#include "compiler/ir/graph.h"

#include <llvm/IR/IRBuilder.h>

#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace tf::codegen {

// Directions that a sweep's loop follows at once: what depends on seeds is a vector of so many numbers. Two vectors where a machine's are
// half as wide: the operations of one wait for each other.
inline constexpr unsigned sweepLanes = ir::Sweep::directions;

// A node's value as a number (of a node that depends on seeds, a vector) and, for Booleans, as a bit; made from one another when first
// needed, so that conditions made of relations never become numbers.
struct Value {
  llvm::Value *number = nullptr;
  llvm::Value *bit = nullptr;
};

// Emits at the builder's position. Values are valid in the scope in which they were made and in scopes opened inside it.
class ExpressionEmitter {
public:
  // `inputs` is the function's first argument: pointers to the arrays of enum tf_in.
  ExpressionEmitter(const ir::Graph &graph, llvm::IRBuilder<> &builder, llvm::Value *inputs)
      : graph_(graph), builder_(builder), inputs_(inputs), scopes_(1) {}

  // Evaluates an operation whose operands have values (constants and symbols are supplied).
  void evaluate(ir::NodeId id);
  // The rows of the sweep's frame: vectors; those of the seeds come first.
  void setFrame(llvm::Value *frame) { frame_ = frame; }
  [[nodiscard]] llvm::Value *rowAddress(int row);
  [[nodiscard]] llvm::Type *rowType() { return llvm::FixedVectorType::get(builder_.getDoubleTy(), sweepLanes); }
  [[nodiscard]] static llvm::Align rowAlignment() { return llvm::Align(sweepLanes * sizeof(double)); }
  void define(ir::NodeId id, llvm::Value *number) { scopes_.back().values[id].number = number; }
  // The constant or symbol has this value instead of its own.
  void replace(ir::NodeId leaf, llvm::Value *number) { replaced_[leaf] = number; }
  // The symbol's entry `index` of its array instead of its own.
  llvm::Value *load(ir::Symbol symbol, llvm::Value *index);
  [[nodiscard]] llvm::Value *number(ir::NodeId id);
  // A load that may be moved and repeated: nothing writes there while the function runs.
  llvm::Value *invariantLoad(llvm::Type *type, llvm::Value *address, const llvm::Twine &name);

  void openScope() { scopes_.emplace_back(); }
  void closeScope() { scopes_.pop_back(); }

private:
  struct Scope {
    std::unordered_map<ir::NodeId, Value> values;
    std::unordered_map<int, llvm::Value *> arrays;  // of enum tf_in
    std::unordered_map<llvm::Value *, llvm::Value *> sinesAndCosines;
  };

  [[nodiscard]] Value *find(ir::NodeId id);
  llvm::Value *bit(ir::NodeId id);
  // An operand of the operation that is being emitted, and a constant, as vectors where one of the operands is.
  llvm::Value *operand(ir::NodeId id);
  llvm::Value *widened(double value);
  llvm::Value *load(ir::Symbol symbol);
  llvm::Value *array(int index);
  Value emit(const ir::Node &node);
  Value emitLogical(const ir::Node &node);
  llvm::Value *emitArithmetic(const ir::Node &node);
  llvm::Value *emitChoice(const ir::Node &node);
  llvm::Value *emitPower(const ir::Node &node);
  llvm::Value *sineAndCosine(llvm::Value *angle);
  llvm::Value *call(std::string_view name, llvm::ArrayRef<llvm::Value *> arguments, bool isBuiltin = true);
  llvm::Value *literal(double value) { return llvm::ConstantFP::get(builder_.getDoubleTy(), value); }

  const ir::Graph &graph_;
  llvm::IRBuilder<> &builder_;
  llvm::Value *inputs_;
  llvm::Value *frame_ = nullptr;
  bool isWide_ = false;  // the operation that is being emitted has vectors as operands
  std::vector<Scope> scopes_;
  std::unordered_map<ir::NodeId, llvm::Value *> replaced_;
};

}  // namespace tf::codegen
