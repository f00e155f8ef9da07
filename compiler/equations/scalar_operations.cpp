// Scalar operations of flat expressions: what becomes a switch, what is selected in place.
#include "compiler/equations/diagnostics.h"
#include "compiler/equations/scalariser.h"

#include <algorithm>

namespace tf::equations {

using flat::Expr;
using flat::Function;
using flat::Operator;
using ir::NodeId;
using ir::Op;

namespace {

std::string_view relationName(Operator op) { return op == Operator::Equal ? "==" : "<>"; }

Op plainOperation(Function function) {
  switch (function) {
  case Function::Sqrt:
    return Op::Sqrt;
  case Function::Sin:
    return Op::Sin;
  case Function::Cos:
    return Op::Cos;
  case Function::Tan:
    return Op::Tan;
  case Function::Asin:
    return Op::Asin;
  case Function::Acos:
    return Op::Acos;
  case Function::Atan:
    return Op::Atan;
  case Function::Sinh:
    return Op::Sinh;
  case Function::Cosh:
    return Op::Cosh;
  case Function::Tanh:
    return Op::Tanh;
  case Function::Exp:
    return Op::Exp;
  case Function::Log:
    return Op::Log;
  default:
    return Op::Log10;
  }
}

}  // namespace

bool Scalariser::isInline(const Expr &expression) const {
  return events_ == Events::None || expression.variability <= flat::Variability::Parameter;
}

// A node that is 0 or 1 whatever happens, so that no step variable is in it.
bool Scalariser::isPlainBoolean(NodeId node) const {
  const ir::Node &n = graph_[node];
  if (n.op == Op::Symbol)
    return n.symbol.kind == ir::SymbolKind::Parameter;
  return n.op == Op::Constant || (n.op >= Op::Less && n.op <= Op::Not);
}

NodeId Scalariser::select(NodeId condition, NodeId a, NodeId b) {
  return graph_.ternary(isPlainBoolean(condition) ? Op::IfElse : Op::Select, condition, a, b);
}

NodeId Scalariser::negation(NodeId a) { return isPlainBoolean(a) ? graph_.unary(Op::Not, a) : graph_.sub(graph_.constant(1), a); }

std::string Scalariser::textOf(const Expr &expression) const {
  if (!expression.span.valid())
    return flat::print(expression, variables_.model());
  std::string text;
  for (const char c : sources_.text(expression.span)) {
    const bool isBlank = c == ' ' || c == '\n' || c == '\t' || c == '\r';
    if (!isBlank)
      text += c;
    else if (!text.empty() && text.back() != ' ')
      text += ' ';
  }
  return text;
}

NodeId Scalariser::switchOn(NodeId condition, bool isContinuous, double atZero, const Expr &expression) {
  const int id =
      provisionals_.addSwitch({condition, isContinuous || events_ == Events::Continuous, atZero, textOf(expression), expression.span});
  return graph_.symbol(ir::SymbolKind::Unknown, id);
}

NodeId Scalariser::scalarBinary(const Expr &expression, NodeId a, NodeId b) {
  const bool arePlain = isPlainBoolean(a) && isPlainBoolean(b);
  switch (expression.op) {
  case Operator::Plus:
    return graph_.add(a, b);
  case Operator::Minus:
    return graph_.sub(a, b);
  case Operator::DotTimes:
    return graph_.mul(a, b);
  case Operator::Divide:
  case Operator::DotDivide:
    return graph_.div(a, b);
  case Operator::DotPower:
    return graph_.binary(Op::Pow, a, b);
  case Operator::And:
    return arePlain ? graph_.binary(Op::And, a, b) : graph_.mul(a, b);
  case Operator::Or:
    return arePlain ? graph_.binary(Op::Or, a, b) : graph_.sub(graph_.add(a, b), graph_.mul(a, b));
  case Operator::Equal:
  case Operator::NotEqual:
    return equality(expression, a, b);
  default:
    return relation(expression, a, b);
  }
}

// c = greater − smaller, alpha = 1 where c > 0.
NodeId Scalariser::relation(const Expr &expression, NodeId a, NodeId b) {
  const bool isLess = expression.op == Operator::Less || expression.op == Operator::LessEqual;
  const bool isStrict = expression.op == Operator::Less || expression.op == Operator::Greater;
  const NodeId greater = isLess ? b : a;
  const NodeId smaller = isLess ? a : b;
  if (isInline(expression))
    return graph_.binary(isStrict ? Op::Less : Op::LessEqual, smaller, greater);
  return switchOn(graph_.sub(greater, smaller), false, isStrict ? 0 : 1, expression);
}

NodeId Scalariser::equality(const Expr &expression, NodeId a, NodeId b) {
  const bool isBoolean = expression.args[0]->type.base == flat::Base::Boolean;
  NodeId equal = -1;
  if (isInline(expression) || (isPlainBoolean(a) && isPlainBoolean(b))) {
    equal = graph_.binary(Op::Equal, a, b);
  } else if (isBoolean) {
    // a·b + (1 − a)(1 − b): multi-affine in the step variables.
    equal = graph_.add(graph_.mul(a, b), graph_.mul(negation(a), negation(b)));
  } else {
    diagnostics_.report(diag::UnsupportedFunction, expression.span,
                        fmt::format("'{}' of a variable that changes during the run", relationName(expression.op)));
    equal = graph_.constant(0);
  }
  return expression.op == Operator::Equal ? equal : negation(equal);
}

NodeId Scalariser::scalarCall(const Expr &expression, std::span<const NodeId> args) {
  switch (expression.function) {
  case Function::Abs:
  case Function::Sign:
  case Function::Min:
  case Function::Max:
    return kinked(expression, args);
  case Function::Div:
  case Function::Mod:
  case Function::Rem:
  case Function::Floor:
  case Function::Ceil:
  case Function::Integer:
    return rounded(expression, args);
  case Function::Atan2:
    return graph_.binary(Op::Atan2, args[0], args[1]);
  default:
    return graph_.unary(plainOperation(expression.function), args[0]);
  }
}

NodeId Scalariser::kinked(const Expr &expression, std::span<const NodeId> args) {
  const bool isUnary = args.size() == 1;
  const NodeId a = args[0];
  if (isInline(expression)) {
    static constexpr Op kUnary[] = {Op::Abs, Op::Sign};
    if (isUnary)
      return graph_.unary(kUnary[expression.function == Function::Sign], a);
    return graph_.binary(expression.function == Function::Min ? Op::Min : Op::Max, a, args[1]);
  }
  switch (expression.function) {
  case Function::Abs:
    return graph_.select(switchOn(a, true, 1, expression), a, graph_.neg(a));
  case Function::Sign:
    return graph_.select(switchOn(a, false, 0.5, expression), graph_.constant(1), graph_.constant(-1));
  case Function::Min:
    return graph_.select(switchOn(graph_.sub(args[1], a), true, 1, expression), a, args[1]);
  default:
    return graph_.select(switchOn(graph_.sub(a, args[1]), true, 1, expression), a, args[1]);
  }
}

NodeId Scalariser::rounded(const Expr &expression, std::span<const NodeId> args) {
  if (!isInline(expression)) {
    diagnostics_.report(diag::EventFunction, expression.span, flat::nameOf(expression.function));
    return graph_.constant(0);
  }
  if (args.size() == 1)
    return graph_.unary(expression.function == Function::Ceil ? Op::Ceil : Op::Floor, args[0]);
  const NodeId quotient = graph_.div(args[0], args[1]);
  const NodeId floor = graph_.unary(Op::Floor, quotient);
  if (expression.function == Function::Mod)
    return graph_.sub(args[0], graph_.mul(floor, args[1]));
  // Integer division truncates towards zero (MLS 3.7.2).
  const NodeId isNegative = graph_.binary(Op::Less, quotient, graph_.constant(0));
  const NodeId truncated = graph_.ternary(Op::IfElse, isNegative, graph_.unary(Op::Ceil, quotient), floor);
  return expression.function == Function::Div ? truncated : graph_.sub(args[0], graph_.mul(truncated, args[1]));
}

}  // namespace tf::equations
