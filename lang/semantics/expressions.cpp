#include "lang/semantics/expressions.h"

#include "lang/semantics/diagnostics.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

namespace tf::semantics {

using flat::Expr;
using flat::ExprKind;
using flat::Operator;

namespace {

Expr node(ExprKind kind, Type type, std::vector<ExprPtr> args, Span span) {
  Expr result;
  result.kind = kind;
  result.type = std::move(type);
  result.span = span;
  for (const ExprPtr &arg : args)
    result.variability = std::max(result.variability, arg->variability);
  result.args = std::move(args);
  return result;
}

bool anyNull(const std::vector<ExprPtr> &parts) {
  return std::ranges::any_of(parts, [](const ExprPtr &part) { return part == nullptr; });
}

ExprPtr typeError(Diagnostics &diagnostics, std::string_view op, const ExprPtr &left, const ExprPtr &right, Span span) {
  diagnostics.report(diag::OperandTypes, span, op, toString(left->type), toString(right->type));
  return nullptr;
}

std::string_view spelling(Operator op) {
  static constexpr std::array<std::string_view, 18> kSpellings = {"",    "+",  "-",   "*", "/",  "^", ".*", "./", ".^",
                                                                  "and", "or", "not", "<", "<=", ">", ">=", "==", "<>"};
  return kSpellings[static_cast<std::size_t>(op)];
}

bool isRelation(Operator op) { return op >= Operator::Less; }

}  // namespace

ExprPtr share(Expr &&expr) {
  for (const ExprPtr &arg : expr.args) {
    expr.height = std::max(expr.height, arg->height + 1);
    expr.nodes += arg->nodes;
  }
  return std::make_shared<const Expr>(std::move(expr));
}

int sizeOf(const std::vector<int> &dims) { return std::accumulate(dims.begin(), dims.end(), 1, std::multiplies<>()); }

std::string toString(const Type &type) {
  static constexpr std::array<std::string_view, 6> kNames = {"Real", "Integer", "Boolean", "String", "enumeration", "Rotation"};
  std::string text(kNames[static_cast<std::size_t>(type.base)]);
  const std::vector<int> dims = visibleDims(type);
  if (dims.empty())
    return text;
  text += "[";
  for (std::size_t i = 0; i < dims.size(); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(dims[i]);
  return text + "]";
}

std::vector<int> visibleDims(const Type &type) {
  std::vector<int> dims = type.dims;
  if (type.base == Base::Rotation && !dims.empty())
    dims.pop_back();
  return dims;
}

bool isConvertible(Base from, Base to) { return from == to || (from == Base::Integer && to == Base::Real); }

ExprPtr makeLiteral(Type type, std::vector<double> values, Span span) {
  assert(static_cast<int>(values.size()) == sizeOf(type.dims));
  Expr expr = node(ExprKind::Literal, std::move(type), {}, span);
  expr.values = std::move(values);
  return share(std::move(expr));
}

ExprPtr makeBlank(Type element, const std::vector<int> &dims, Span span) {
  element.dims.insert(element.dims.begin(), dims.begin(), dims.end());
  const int count = sizeOf(element.dims);
  if (element.base == Base::String && count > 0)
    return broadcast(makeString({}, span), element.dims);
  return makeLiteral(std::move(element), std::vector<double>(static_cast<std::size_t>(count)), span);
}

ExprPtr makeReal(double value, Span span) { return makeLiteral({Base::Real, {}}, {value}, span); }
ExprPtr makeInteger(double value, Span span) { return makeLiteral({Base::Integer, {}}, {value}, span); }
ExprPtr makeBoolean(bool value, Span span) { return makeLiteral({Base::Boolean, {}}, {value ? 1.0 : 0.0}, span); }

ExprPtr makeString(std::string text, Span span) {
  Expr expr = node(ExprKind::Literal, {Base::String, {}}, {}, span);
  expr.values = {0};
  expr.text = std::move(text);
  return share(std::move(expr));
}

ExprPtr toReal(const ExprPtr &value) {
  if (value == nullptr || value->type.base != Base::Integer)
    return value;
  Expr copy = *value;
  copy.height = 1;
  copy.nodes = 1;
  copy.type.base = Base::Real;
  if (copy.kind == ExprKind::Array || copy.kind == ExprKind::Concatenate)
    for (ExprPtr &arg : copy.args)
      arg = toReal(arg);
  if (copy.kind == ExprKind::If)
    for (std::size_t i = 1; i < copy.args.size(); ++i)
      copy.args[i] = toReal(copy.args[i]);
  return share(std::move(copy));
}

ExprPtr makeUnary(Operator op, ExprPtr operand, Span span, Diagnostics &diagnostics) {
  if (operand == nullptr)
    return nullptr;
  const bool isLogical = op == Operator::Not;
  if (isLogical ? operand->type.base != Base::Boolean : !isNumeric(operand->type.base)) {
    diagnostics.report(diag::OperandType, operand->span, isLogical ? "not" : "-", isLogical ? "Boolean" : "a number",
                       toString(operand->type));
    return nullptr;
  }
  if (op == Operator::Plus)
    return operand;
  if (op == Operator::Minus && operand->kind == ExprKind::Literal) {
    std::vector<double> values = operand->values;
    for (double &value : values)
      value = -value;
    return makeLiteral(operand->type, std::move(values), span);
  }
  const Type type = operand->type;
  Expr expr = node(ExprKind::Unary, type, {std::move(operand)}, span);
  expr.op = op;
  return share(std::move(expr));
}

namespace {

ExprPtr binaryNode(Operator op, Type type, ExprPtr left, ExprPtr right, Span span) {
  Expr expr = node(ExprKind::Binary, std::move(type), {std::move(left), std::move(right)}, span);
  expr.op = op;
  return share(std::move(expr));
}

// A scalar beside an array takes the array's shape.
bool matchShapes(ExprPtr &left, ExprPtr &right) {
  if (left->type.dims.empty() && !right->type.dims.empty())
    left = broadcast(left, right->type.dims);
  else if (right->type.dims.empty() && !left->type.dims.empty())
    right = broadcast(right, left->type.dims);
  return left->type.dims == right->type.dims;
}

// Dimensions of a matrix product, or nothing.
bool productDims(const std::vector<int> &left, const std::vector<int> &right, std::vector<int> &result) {
  if (left.empty() || right.empty()) {
    result = left.empty() ? right : left;
    return true;
  }
  if (left.size() > 2 || right.size() > 2 || left.back() != right.front())
    return false;
  result.assign(left.begin(), left.end() - 1);
  result.insert(result.end(), right.begin() + 1, right.end());
  return true;
}

ExprPtr makePower(ExprPtr base, ExprPtr exponent, Span span, Diagnostics &diagnostics) {
  const std::vector<int> dims = base->type.dims;
  if (dims.empty() && exponent->type.dims.empty())
    return binaryNode(Operator::Power, {Base::Real, {}}, std::move(base), std::move(exponent), span);
  const bool isSquare = dims.size() == 2 && dims[0] == dims[1];
  const bool isCount = exponent->kind == ExprKind::Literal && exponent->type == Type{Base::Integer, {}} && exponent->values[0] >= 0 &&
                       exponent->values[0] <= 64;
  if (!isSquare || !isCount)
    return typeError(diagnostics, "^", base, exponent, span);
  std::vector<double> identity(static_cast<std::size_t>(sizeOf(dims)), 0.0);
  for (int i = 0; i < dims[0]; ++i)
    identity[static_cast<std::size_t>(i) * dims[0] + i] = 1;
  const int count = static_cast<int>(exponent->values[0]);
  ExprPtr product = count == 0 ? makeLiteral({Base::Real, dims}, std::move(identity), span) : base;
  for (int i = 1; i < count; ++i)
    product = binaryNode(Operator::Times, {Base::Real, dims}, product, base, span);
  return product;
}

ExprPtr makeRelation(Operator op, ExprPtr left, ExprPtr right, Span span, Diagnostics &diagnostics) {
  const Base a = left->type.base, b = right->type.base;
  const bool isComparable = isNumeric(a) ? isNumeric(b) : a == b;
  if (!isComparable || !left->type.dims.empty() || !right->type.dims.empty())
    return typeError(diagnostics, spelling(op), left, right, span);
  return binaryNode(op, {Base::Boolean, {}}, std::move(left), std::move(right), span);
}

ExprPtr makeLogical(Operator op, ExprPtr left, ExprPtr right, Span span, Diagnostics &diagnostics) {
  if (left->type.base != Base::Boolean || left->type != right->type)
    return typeError(diagnostics, spelling(op), left, right, span);
  const Type type = left->type;
  return binaryNode(op, type, std::move(left), std::move(right), span);
}

// R*r: the vector in the world's frame; R1*R2: first R2, then R1.
ExprPtr makeTurned(ExprPtr left, ExprPtr right, Span span, Diagnostics &diagnostics) {
  if (isRotation(right->type)) {
    const Type type = left->type;
    return makeCall(flat::Function::RotationProduct, type, {std::move(left), std::move(right)}, span);
  }
  if (!isNumeric(right->type.base) || right->type.dims != std::vector<int>{3})
    return typeError(diagnostics, "*", left, right, span);
  return makeCall(flat::Function::Rotate, {Base::Real, {3}}, {std::move(left), toReal(right)}, span);
}

}  // namespace

ExprPtr makeBinary(Operator op, ExprPtr left, ExprPtr right, Span span, Diagnostics &diagnostics, bool isElementwise) {
  if (left == nullptr || right == nullptr)
    return nullptr;
  if (isRelation(op))
    return makeRelation(op, std::move(left), std::move(right), span, diagnostics);
  if (op == Operator::And || op == Operator::Or)
    return makeLogical(op, std::move(left), std::move(right), span, diagnostics);
  if (op == Operator::Plus && left->type.base == Base::String && left->type == right->type && left->kind == ExprKind::Literal &&
      right->kind == ExprKind::Literal && left->type.dims.empty())
    return makeString(left->text + right->text, span);
  if (op == Operator::Times && isRotation(left->type))
    return makeTurned(std::move(left), std::move(right), span, diagnostics);
  if (!isNumeric(left->type.base) || !isNumeric(right->type.base))
    return typeError(diagnostics, spelling(op), left, right, span);
  const Base base = left->type.base == Base::Integer && right->type.base == Base::Integer ? Base::Integer : Base::Real;
  switch (op) {
  case Operator::Plus:
  case Operator::Minus:
    if (isElementwise ? !matchShapes(left, right) : left->type.dims != right->type.dims)
      return typeError(diagnostics, spelling(op), left, right, span);
    return binaryNode(op, {base, left->type.dims}, left, right, span);
  case Operator::Times: {
    std::vector<int> dims;
    if (!productDims(left->type.dims, right->type.dims, dims))
      return typeError(diagnostics, "*", left, right, span);
    return binaryNode(op, {base, dims}, left, right, span);
  }
  case Operator::Divide:
    if (!right->type.dims.empty())
      return typeError(diagnostics, "/", left, right, span);
    return binaryNode(op, {Base::Real, left->type.dims}, left, right, span);
  case Operator::Power:
    return makePower(std::move(left), std::move(right), span, diagnostics);
  default:
    break;
  }
  if (!matchShapes(left, right))
    return typeError(diagnostics, spelling(op), left, right, span);
  return binaryNode(op, {op == Operator::DotTimes ? base : Base::Real, left->type.dims}, left, right, span);
}

ExprPtr makeIf(ExprPtr condition, ExprPtr thenValue, ExprPtr elseValue, Span span, Diagnostics &diagnostics) {
  if (condition == nullptr || thenValue == nullptr || elseValue == nullptr)
    return nullptr;
  if (condition->type != Type{Base::Boolean, {}}) {
    diagnostics.report(diag::ConditionType, condition->span, toString(condition->type));
    return nullptr;
  }
  if (thenValue->type.base == Base::Real)
    elseValue = toReal(elseValue);
  if (elseValue->type.base == Base::Real)
    thenValue = toReal(thenValue);
  if (thenValue->type != elseValue->type) {
    diagnostics.report(diag::BranchTypes, span, toString(thenValue->type), toString(elseValue->type));
    return nullptr;
  }
  const Type type = thenValue->type;
  if (type.base == Base::Rotation && condition->variability > Variability::Parameter) {
    diagnostics.report(diag::NotSupported, span, "'if' between rotations");
    return nullptr;
  }
  return share(node(ExprKind::If, type, {std::move(condition), std::move(thenValue), std::move(elseValue)}, span));
}

ExprPtr makeArray(std::vector<ExprPtr> parts, Span span, Diagnostics &diagnostics) {
  if (parts.empty() || anyNull(parts))
    return nullptr;
  const bool hasReal = std::ranges::any_of(parts, [](const ExprPtr &part) { return part->type.base == Base::Real; });
  if (hasReal)
    for (ExprPtr &part : parts)
      part = toReal(part);
  for (const ExprPtr &part : parts)
    if (part->type != parts[0]->type) {
      diagnostics.report(diag::ArrayElementTypes, part->span, toString(part->type), toString(parts[0]->type));
      return nullptr;
    }
  Type type = parts[0]->type;
  type.dims.insert(type.dims.begin(), static_cast<int>(parts.size()));
  const bool isLiteral =
      type.base != Base::String && std::ranges::all_of(parts, [](const ExprPtr &part) { return part->kind == ExprKind::Literal; });
  if (!isLiteral)
    return share(node(ExprKind::Array, std::move(type), std::move(parts), span));
  std::vector<double> values;
  for (const ExprPtr &part : parts)
    values.insert(values.end(), part->values.begin(), part->values.end());
  return makeLiteral(std::move(type), std::move(values), span);
}

ExprPtr makeCall(flat::Function function, Type type, std::vector<ExprPtr> arguments, Span span) {
  if (anyNull(arguments))
    return nullptr;
  Expr expr = node(ExprKind::Call, std::move(type), std::move(arguments), span);
  expr.function = function;
  return share(std::move(expr));
}

ExprPtr makeDerivative(ExprPtr operand, Span span) {
  if (operand == nullptr)
    return nullptr;
  operand = toReal(operand);
  const Type type = operand->type;
  return share(node(ExprKind::Derivative, type, {std::move(operand)}, span));
}

ExprPtr makeConcatenation(std::vector<ExprPtr> parts, int axis, Span span, Diagnostics &diagnostics) {
  if (parts.empty() || anyNull(parts))
    return nullptr;
  if (parts.size() == 1)
    return parts[0];
  const bool hasReal = std::ranges::any_of(parts, [](const ExprPtr &part) { return part->type.base == Base::Real; });
  if (hasReal)
    for (ExprPtr &part : parts)
      part = toReal(part);
  Type type = parts[0]->type;
  const auto at = static_cast<std::size_t>(axis);
  int length = 0;
  for (const ExprPtr &part : parts) {
    Type same = part->type;
    bool fits = same.dims.size() == type.dims.size() && at < same.dims.size();
    if (fits) {
      length += same.dims[at];
      same.dims[at] = type.dims[at];
      fits = same == type;
    }
    if (!fits) {
      diagnostics.report(diag::ConcatenationTypes, part->span, toString(part->type), toString(parts[0]->type));
      return nullptr;
    }
  }
  type.dims[at] = length;
  Expr expr = node(ExprKind::Concatenate, std::move(type), std::move(parts), span);
  expr.axis = axis;
  return share(std::move(expr));
}

}  // namespace tf::semantics
