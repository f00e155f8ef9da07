#include "compiler/codegen/expression_emitter.h"

#include "compiler/codegen/math_library.h"
#include "compiler/codegen/trigonometry_emitter.h"
#include "compiler/ir/operations.h"
#include "runtime/abi/tf_model.h"

#include <llvm/IR/Module.h>

#include <cassert>
#include <cstdlib>

namespace tf::codegen {

namespace {

using ir::Op;

struct Argument {
  int array;
  const char *name;
};

Argument argumentOf(ir::SymbolKind kind) {
  switch (kind) {
  case ir::SymbolKind::Time:
    return {TF_IN_TIME, "time"};
  case ir::SymbolKind::Coordinate:
    return {TF_IN_Q, "q"};
  case ir::SymbolKind::Velocity:
    return {TF_IN_V, "v"};
  case ir::SymbolKind::State:
    return {TF_IN_Z, "z"};
  case ir::SymbolKind::Input:
    return {TF_IN_U, "u"};
  case ir::SymbolKind::Parameter:
    return {TF_IN_P, "p"};
  case ir::SymbolKind::StepVariable:
    return {TF_IN_ALPHA, "alpha"};
  case ir::SymbolKind::Acceleration:
    return {TF_IN_A, "a"};
  case ir::SymbolKind::NormalForce:
    return {TF_IN_NORMAL, "normal"};
  case ir::SymbolKind::TangentForce:
    return {TF_IN_TANGENT, "tangent"};
  case ir::SymbolKind::Multiplier:
    return {TF_IN_MULTIPLIER, "multiplier"};
  case ir::SymbolKind::StateDerivative:
    return {TF_IN_ZDOT, "zdot"};
  case ir::SymbolKind::Radius:
    return {TF_IN_RADIUS, "radius"};
  case ir::SymbolKind::Seed:     // a row of the sweep's frame
  case ir::SymbolKind::Unknown:  // of equations that are being solved; a system has none
    break;
  }
  assert(false && "not an argument of generated functions");
  return {0, ""};
}

const char *const arrayNames[TF_IN_COUNT] = {"time.in", "q.in",          "v.in",      "z.in",         "u.in",
                                             "p.in",    "alpha.in",      "a.in",      "normal.in",    "tangent.in",
                                             "zdot.in", "multiplier.in", "radius.in", "directions.in"};

}  // namespace

Value *ExpressionEmitter::find(ir::NodeId id) {
  for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope)
    if (const auto found = scope->values.find(id); found != scope->values.end())
      return &found->second;
  return nullptr;
}

llvm::Value *ExpressionEmitter::number(ir::NodeId id) {
  const ir::Node &node = graph_[id];
  if (const auto replaced = replaced_.find(id); node.arity == 0 && replaced != replaced_.end())
    return replaced->second;
  if (node.op == Op::Constant)
    return literal(node.value);
  Value *value = find(id);
  if (value == nullptr) {
    assert(node.op == Op::Symbol && "an operand is evaluated before its use");
    value = &scopes_.back().values[id];
    value->number = load(node.symbol);
  }
  if (value->number != nullptr)
    return value->number;
  // Kept with the innermost scope: the conversion is emitted there.
  llvm::Value *converted = builder_.CreateUIToFP(value->bit, builder_.getDoubleTy());
  scopes_.back().values[id] = {converted, value->bit};
  return converted;
}

llvm::Value *ExpressionEmitter::bit(ir::NodeId id) {
  if (const Value *value = find(id); value != nullptr && value->bit != nullptr)
    return value->bit;
  llvm::Value *truth = builder_.CreateFCmpUNE(number(id), literal(0));
  scopes_.back().values[id] = {number(id), truth};
  return truth;
}

llvm::Value *ExpressionEmitter::invariantLoad(llvm::Type *type, llvm::Value *address, const llvm::Twine &name) {
  llvm::LoadInst *load = builder_.CreateAlignedLoad(type, address, type->isVectorTy() ? rowAlignment() : llvm::Align(8), name);
  llvm::MDNode *mark = llvm::MDNode::get(builder_.getContext(), {});
  load->setMetadata(llvm::LLVMContext::MD_invariant_load, mark);
  load->setMetadata(llvm::LLVMContext::MD_noundef, mark);
  if (type->isPointerTy())
    load->setMetadata(llvm::LLVMContext::MD_nonnull, mark);
  return load;
}

llvm::Value *ExpressionEmitter::array(int index) {
  for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope)
    if (const auto found = scope->arrays.find(index); found != scope->arrays.end())
      return found->second;
  llvm::Value *slot = builder_.CreateConstInBoundsGEP1_32(builder_.getPtrTy(), inputs_, static_cast<unsigned>(index));
  llvm::Value *pointer = invariantLoad(builder_.getPtrTy(), slot, arrayNames[index]);
  scopes_.back().arrays[index] = pointer;
  return pointer;
}

llvm::Value *ExpressionEmitter::rowAddress(int row) {
  return builder_.CreateConstInBoundsGEP1_32(rowType(), frame_, static_cast<unsigned>(row));
}

llvm::Value *ExpressionEmitter::load(ir::Symbol symbol) {
  if (symbol.kind == ir::SymbolKind::Seed)
    return builder_.CreateAlignedLoad(rowType(), rowAddress(symbol.index), rowAlignment());
  const auto [index, name] = argumentOf(symbol.kind);
  llvm::Value *address = builder_.CreateConstInBoundsGEP1_32(builder_.getDoubleTy(), array(index), static_cast<unsigned>(symbol.index));
  return invariantLoad(builder_.getDoubleTy(), address, symbol.kind == ir::SymbolKind::Time ? name : name + llvm::Twine(symbol.index));
}

llvm::Value *ExpressionEmitter::load(ir::Symbol symbol, llvm::Value *index) {
  if (symbol.kind == ir::SymbolKind::Seed)
    return builder_.CreateAlignedLoad(rowType(), builder_.CreateInBoundsGEP(rowType(), frame_, index), rowAlignment());
  llvm::Value *address = builder_.CreateInBoundsGEP(builder_.getDoubleTy(), array(argumentOf(symbol.kind).array), index);
  return invariantLoad(builder_.getDoubleTy(), address, "");
}

void ExpressionEmitter::evaluate(ir::NodeId id) {
  const ir::Node &node = graph_[id];
  for (int k = 0; k < node.arity; ++k)  // loads in the order of the operands, whatever the order of evaluation of arguments in C++
    if (graph_[node.operands[k]].op == Op::Symbol)
      static_cast<void>(number(node.operands[k]));
  isWide_ = false;
  for (int k = 0; k < node.arity; ++k)
    if (const Value *operand = find(node.operands[k]); operand != nullptr && operand->number != nullptr)
      isWide_ = isWide_ || operand->number->getType()->isVectorTy();
    else if (const auto replaced = replaced_.find(node.operands[k]); replaced != replaced_.end())
      isWide_ = isWide_ || replaced->second->getType()->isVectorTy();
  const Value value = emit(node);
  isWide_ = false;
  scopes_.back().values[id] = value;
}

llvm::Value *ExpressionEmitter::widened(double value) { return llvm::ConstantFP::get(isWide_ ? rowType() : builder_.getDoubleTy(), value); }

llvm::Value *ExpressionEmitter::operand(ir::NodeId id) {
  llvm::Value *value = number(id);
  return isWide_ && !value->getType()->isVectorTy() ? builder_.CreateVectorSplat(sweepLanes, value) : value;
}

Value ExpressionEmitter::emit(const ir::Node &node) {
  if (ir::isBoolean(node.op))
    return emitLogical(node);
  switch (node.op) {
  case Op::IfElse:
  case Op::Select:
  case Op::Min:
  case Op::Max:
  case Op::Sign:
    return {emitChoice(node), nullptr};
  case Op::Pow:
    return {emitPower(node), nullptr};
  default:
    return {emitArithmetic(node), nullptr};
  }
}

Value ExpressionEmitter::emitLogical(const ir::Node &node) {
  const auto a = [&] { return number(node.operands[0]); };
  const auto b = [&] { return number(node.operands[1]); };
  switch (node.op) {
  case Op::Less:
    return {nullptr, builder_.CreateFCmpOLT(a(), b())};
  case Op::LessEqual:
    return {nullptr, builder_.CreateFCmpOLE(a(), b())};
  case Op::Equal:
    return {nullptr, builder_.CreateFCmpOEQ(a(), b())};
  case Op::And:
    return {nullptr, builder_.CreateAnd(bit(node.operands[0]), bit(node.operands[1]))};
  case Op::Or:
    return {nullptr, builder_.CreateOr(bit(node.operands[0]), bit(node.operands[1]))};
  default:
    return {nullptr, builder_.CreateNot(bit(node.operands[0]))};
  }
}

llvm::Value *ExpressionEmitter::emitChoice(const ir::Node &node) {
  const ir::NodeId *x = node.operands;
  switch (node.op) {
  case Op::IfElse:
    return builder_.CreateSelect(bit(x[0]), operand(x[1]), operand(x[2]));
  case Op::Min:
    return builder_.CreateSelect(builder_.CreateFCmpOLT(operand(x[1]), operand(x[0])), operand(x[1]), operand(x[0]));
  case Op::Max:
    return builder_.CreateSelect(builder_.CreateFCmpOGT(operand(x[1]), operand(x[0])), operand(x[1]), operand(x[0]));
  case Op::Sign: {
    llvm::Value *zero = widened(0);
    llvm::Value *negative = builder_.CreateSelect(builder_.CreateFCmpOLT(operand(x[0]), zero), widened(-1), zero);
    return builder_.CreateSelect(builder_.CreateFCmpOGT(operand(x[0]), zero), widened(1), negative);
  }
  default: {  // Select: alpha = 1, alpha = 0, between
    llvm::Value *alpha = operand(x[0]);
    llvm::Value *one = widened(1);
    llvm::Value *first = builder_.CreateFMul(alpha, operand(x[1]));
    llvm::Value *second = builder_.CreateFMul(builder_.CreateFSub(one, alpha), operand(x[2]));
    llvm::Value *blend = builder_.CreateFAdd(first, second);
    llvm::Value *lower = builder_.CreateSelect(builder_.CreateFCmpOEQ(alpha, widened(0)), operand(x[2]), blend);
    return builder_.CreateSelect(builder_.CreateFCmpOEQ(alpha, one), operand(x[1]), lower);
  }
  }
}

// As ir::integerPower multiplies.
llvm::Value *ExpressionEmitter::emitPower(const ir::Node &node) {
  llvm::Value *base = number(node.operands[0]);
  const std::optional<int> exponent = ir::multipliedExponent(graph_, node.operands[1]);
  if (!exponent)
    return call("pow", {base, number(node.operands[1])}, false);
  llvm::Value *result = nullptr;
  for (unsigned bits = static_cast<unsigned>(std::abs(*exponent)); bits != 0; bits >>= 1U) {
    if ((bits & 1U) != 0)
      result = result == nullptr ? base : builder_.CreateFMul(result, base);
    if (bits > 1)
      base = builder_.CreateFMul(base, base);
  }
  if (result == nullptr)
    return literal(1);
  return *exponent < 0 ? builder_.CreateFDiv(literal(1), result) : result;
}

llvm::Value *ExpressionEmitter::emitArithmetic(const ir::Node &node) {
  const auto a = [&] { return operand(node.operands[0]); };
  const auto b = [&] { return operand(node.operands[1]); };
  const auto intrinsic = [&](llvm::Intrinsic::ID id) { return builder_.CreateUnaryIntrinsic(id, a()); };
  switch (node.op) {
  case Op::Neg:
    return builder_.CreateFNeg(a());
  case Op::Add:
    return builder_.CreateFAdd(a(), b());
  case Op::Sub:
    return builder_.CreateFSub(a(), b());
  case Op::Mul:
    return builder_.CreateFMul(a(), b());
  case Op::Div:
    return builder_.CreateFDiv(a(), b());
  case Op::Sqrt:
    return intrinsic(llvm::Intrinsic::sqrt);
  case Op::Abs:
    return intrinsic(llvm::Intrinsic::fabs);
  case Op::Floor:
    return intrinsic(llvm::Intrinsic::floor);
  case Op::Ceil:
    return intrinsic(llvm::Intrinsic::ceil);
  case Op::Atan2:
    return call("atan2", {a(), b()});
  case Op::Sin:
    return builder_.CreateExtractValue(sineAndCosine(a()), 0);
  case Op::Cos:
    return builder_.CreateExtractValue(sineAndCosine(a()), 1);
  default:
    return call(libraryName(node.op), {a()});
  }
}

// One call for both.
llvm::Value *ExpressionEmitter::sineAndCosine(llvm::Value *angle) {
  for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope)
    if (const auto found = scope->sinesAndCosines.find(angle); found != scope->sinesAndCosines.end())
      return found->second;
  llvm::Value *both = builder_.CreateCall(sineAndCosineFunction(*builder_.GetInsertBlock()->getModule()), angle);
  scopes_.back().sinesAndCosines[angle] = both;
  return both;
}

// What is no builtin, LLVM does not replace by another function (pow(2, x) by exp2(x)), whose last bit may differ.
llvm::Value *ExpressionEmitter::call(std::string_view name, llvm::ArrayRef<llvm::Value *> arguments, bool isBuiltin) {
  llvm::Module &module = *builder_.GetInsertBlock()->getModule();
  llvm::CallInst *result = builder_.CreateCall(mathFunction(module, name, arguments.size()), arguments);
  if (!isBuiltin)
    result->addFnAttr(llvm::Attribute::NoBuiltin);
  return result;
}

}  // namespace tf::codegen
