// Construction of nodes with simplification. Rules are exact in IEEE arithmetic up to the sign of zero and the treatment of infinities and
// NaN (x − x, 0·x), except that constant factors of one product are multiplied together and those of the same factor added. Each rule
// strips a level of its operands, which are already simplified, so that the calls below nest a few levels deep at most.
#include "compiler/ir/graph.h"
#include "compiler/ir/operations.h"

#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace tf::ir {

namespace {

bool isPowerOfTwo(double value) {
  int exponent = 0;
  return std::isfinite(value) && std::fabs(std::frexp(value, &exponent)) == 0.5 && std::abs(exponent) < 256;
}

bool isCommutative(Op op) { return op == Op::Add || op == Op::Mul || op == Op::Equal || op == Op::And || op == Op::Or; }

bool isOdd(Op op) {
  return op == Op::Sin || op == Op::Tan || op == Op::Asin || op == Op::Atan || op == Op::Sinh || op == Op::Tanh || op == Op::Sign;
}

bool isEven(Op op) { return op == Op::Cos || op == Op::Cosh || op == Op::Abs; }

// The constant that a product begins with.
struct Factored {
  double factor;
  NodeId rest;
};

Factored factored(const Graph &graph, NodeId id) {
  const Node &node = graph[id];
  if (node.op == Op::Mul && graph[node.operands[0]].op == Op::Constant)
    return {graph[node.operands[0]].value, node.operands[1]};
  return {1, id};
}

}  // namespace

NodeId Graph::unary(Op op, NodeId a) {
  const Node operand = (*this)[a];
  if (operand.op == Op::Constant) {
    const double value = applyOperation(op, std::array{operand.value});
    if (std::isfinite(value))
      return constant(value);
  }
  if (operand.op == Op::Neg && isOdd(op))
    return neg(unary(op, operand.operands[0]));
  if (operand.op == Op::Neg && isEven(op))
    return unary(op, operand.operands[0]);
  if (op == Op::Neg) {
    if (operand.op == Op::Neg)
      return operand.operands[0];
    if (operand.op == Op::Sub)
      return sub(operand.operands[1], operand.operands[0]);
    if (const auto [factor, rest] = factored(*this, a); factor != 1)
      return mul(constant(-factor), rest);
  }
  if (op == Op::Abs && (operand.op == Op::Abs || operand.op == Op::Sqrt || operand.op == Op::Exp || isBoolean(operand.op)))
    return a;
  if ((op == Op::Floor || op == Op::Ceil) && (operand.op == Op::Floor || operand.op == Op::Ceil || isBoolean(operand.op)))
    return a;
  if (op == Op::Not && operand.op == Op::Not && isBoolean((*this)[operand.operands[0]].op))
    return operand.operands[0];
  return operation(op, std::array{a});
}

NodeId Graph::binary(Op op, NodeId a, NodeId b) {
  if ((*this)[a].op == Op::Constant && (*this)[b].op == Op::Constant) {
    const double value = applyOperation(op, std::array{(*this)[a].value, (*this)[b].value});
    if (std::isfinite(value))
      return constant(value);
  }
  // One order of operands for commutative operations: the constant first, then by id. Conditions are kept as written.
  if (isCommutative(op)) {
    const auto rank = [&](NodeId id) { return std::pair((*this)[id].op != Op::Constant, op == Op::Add || op == Op::Mul ? id : 0); };
    if (rank(b) < rank(a))
      std::swap(a, b);
  }
  switch (op) {
  case Op::Add:
    return addition(a, b);
  case Op::Sub:
    return subtraction(a, b);
  case Op::Mul:
    return product(a, b);
  case Op::Div:
    return quotient(a, b);
  case Op::Pow:
    return power(a, b);
  case Op::Min:
  case Op::Max:
    return a == b ? a : operation(op, std::array{a, b});
  case Op::Less:
    return a == b ? constant(0) : operation(op, std::array{a, b});
  case Op::LessEqual:
  case Op::Equal:
    return a == b ? constant(1) : operation(op, std::array{a, b});
  case Op::And:
  case Op::Or:
    return logical(op, a, b);
  default:
    return operation(op, std::array{a, b});
  }
}

NodeId Graph::addition(NodeId a, NodeId b) {
  const Node left = (*this)[a];
  const Node right = (*this)[b];
  if (isConstant(a, 0))
    return b;
  const auto [leftFactor, leftRest] = factored(*this, a);
  const auto [rightFactor, rightRest] = factored(*this, b);
  if (leftRest == rightRest && left.op != Op::Constant)
    return mul(constant(leftFactor + rightFactor), leftRest);
  if (right.op == Op::Neg)
    return sub(a, right.operands[0]);
  if (left.op == Op::Neg)
    return sub(b, left.operands[0]);
  if (left.op == Op::Constant && left.value < 0)
    return sub(b, constant(-left.value));
  if (rightFactor < 0)
    return sub(a, mul(constant(-rightFactor), rightRest));
  if (leftFactor < 0)
    return sub(b, mul(constant(-leftFactor), leftRest));
  return operation(Op::Add, std::array{a, b});
}

NodeId Graph::subtraction(NodeId a, NodeId b) {
  const Node left = (*this)[a];
  const Node right = (*this)[b];
  if (a == b)
    return constant(0);
  if (isConstant(b, 0))
    return a;
  if (isConstant(a, 0))
    return neg(b);
  const auto [leftFactor, leftRest] = factored(*this, a);
  const auto [rightFactor, rightRest] = factored(*this, b);
  if (leftRest == rightRest && left.op != Op::Constant)
    return mul(constant(leftFactor - rightFactor), leftRest);
  if (right.op == Op::Neg)
    return add(a, right.operands[0]);
  if (left.op == Op::Neg)
    return neg(add(left.operands[0], b));
  if (right.op == Op::Constant && right.value < 0)
    return add(a, constant(-right.value));
  if (rightFactor < 0)
    return add(a, mul(constant(-rightFactor), rightRest));
  return operation(Op::Sub, std::array{a, b});
}

NodeId Graph::product(NodeId a, NodeId b) {
  const Node left = (*this)[a];
  const Node right = (*this)[b];
  if (isConstant(a, 0) || isConstant(b, 0))
    return constant(0);
  if (isConstant(a, 1))
    return b;
  if (isConstant(a, -1))
    return neg(b);
  if (left.op == Op::Neg || right.op == Op::Neg) {
    const NodeId unsignedProduct = mul(left.op == Op::Neg ? left.operands[0] : a, right.op == Op::Neg ? right.operands[0] : b);
    return left.op == right.op ? unsignedProduct : neg(unsignedProduct);
  }
  if (left.op == Op::Constant) {
    const auto [factor, rest] = factored(*this, b);
    const double merged = left.value * factor;
    if (factor != 1 && std::isnormal(merged))
      return mul(constant(merged), rest);
    return operation(Op::Mul, std::array{a, b});
  }
  // Powers of two are carried outwards: 1/2·(m·(2·v)) becomes m·v, without a change of rounding.
  const auto [leftFactor, leftRest] = factored(*this, a);
  const auto [rightFactor, rightRest] = factored(*this, b);
  const bool carryLeft = leftFactor != 1 && isPowerOfTwo(leftFactor);
  const bool carryRight = rightFactor != 1 && isPowerOfTwo(rightFactor);
  if (carryLeft || carryRight) {
    const double carried = (carryLeft ? leftFactor : 1) * (carryRight ? rightFactor : 1);
    return mul(constant(carried), mul(carryLeft ? leftRest : a, carryRight ? rightRest : b));
  }
  return operation(Op::Mul, std::array{a, b});
}

NodeId Graph::quotient(NodeId a, NodeId b) {
  const Node left = (*this)[a];
  const Node right = (*this)[b];
  if (isConstant(a, 0) && !isConstant(b, 0))
    return a;
  if (right.op == Op::Constant && isPowerOfTwo(right.value))
    return mul(constant(1 / right.value), a);
  if (left.op == Op::Neg || right.op == Op::Neg) {
    const NodeId unsignedQuotient = div(left.op == Op::Neg ? left.operands[0] : a, right.op == Op::Neg ? right.operands[0] : b);
    return left.op == right.op ? unsignedQuotient : neg(unsignedQuotient);
  }
  return operation(Op::Div, std::array{a, b});
}

NodeId Graph::power(NodeId a, NodeId b) {
  if (isConstant(b, 0) || isConstant(a, 1))
    return constant(1);
  if (isConstant(b, 1))
    return a;
  if (isConstant(b, 2))
    return mul(a, a);
  if (isConstant(b, -1))
    return div(constant(1), a);
  if (isConstant(b, 0.5))
    return unary(Op::Sqrt, a);
  return operation(Op::Pow, std::array{a, b});
}

// `a` is the constant, if one is.
NodeId Graph::logical(Op op, NodeId a, NodeId b) {
  if ((*this)[a].op == Op::Constant) {
    const bool decided = isConstant(a, 0) == (op == Op::And);
    if (decided)
      return constant(op == Op::And ? 0 : 1);
    if (isBoolean((*this)[b].op))
      return b;
  }
  if (a == b && isBoolean((*this)[a].op))
    return a;
  return operation(op, std::array{a, b});
}

NodeId Graph::ternary(Op op, NodeId a, NodeId b, NodeId c) {
  assert(op == Op::IfElse || op == Op::Select);
  const Node condition = (*this)[a];
  if (b == c)
    return b;
  if (condition.op == Op::Constant) {
    if (op == Op::IfElse)
      return condition.value != 0 ? b : c;
    if (condition.value == 1)
      return b;
    if (condition.value == 0)
      return c;
  }
  if (op == Op::IfElse && condition.op == Op::Not)
    return ternary(op, condition.operands[0], c, b);
  return operation(op, std::array{a, b, c});
}

}  // namespace tf::ir
