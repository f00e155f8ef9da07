// Properties of the operations: arity, names, and how an integer power is multiplied out.
#pragma once

#include "compiler/ir/graph.h"

#include <optional>
#include <string_view>

namespace tf::ir {

[[nodiscard]] constexpr int arity(Op op) {
  switch (op) {
  case Op::Constant:
  case Op::Symbol:
    return 0;
  case Op::Add:
  case Op::Sub:
  case Op::Mul:
  case Op::Div:
  case Op::Pow:
  case Op::Atan2:
  case Op::Min:
  case Op::Max:
  case Op::Less:
  case Op::LessEqual:
  case Op::Equal:
  case Op::And:
  case Op::Or:
    return 2;
  case Op::IfElse:
  case Op::Select:
    return 3;
  default:
    return 1;
  }
}

// The value is 0 or 1.
[[nodiscard]] constexpr bool isBoolean(Op op) {
  return op == Op::Less || op == Op::LessEqual || op == Op::Equal || op == Op::And || op == Op::Or || op == Op::Not;
}

// Function notation ("sin", "atan2"); empty for operators and leaves.
[[nodiscard]] std::string_view functionName(Op op);

// Powers with constant integer exponents up to this size are products (square and multiply, from the lowest bit of the exponent; a negative
// exponent is the reciprocal of the positive power); beyond it, and for other exponents, they are pow of the math library.
inline constexpr int largestMultipliedPower = 64;
[[nodiscard]] std::optional<int> multipliedExponent(const Graph &graph, NodeId exponent);
[[nodiscard]] double integerPower(double base, int exponent);

}  // namespace tf::ir
