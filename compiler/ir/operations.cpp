#include "compiler/ir/operations.h"

#include "lang/base/trigonometry.h"

#include <cassert>
#include <cmath>
#include <cstdlib>

namespace tf::ir {

std::string_view functionName(Op op) {
  switch (op) {
  case Op::Sqrt:
    return "sqrt";
  case Op::Exp:
    return "exp";
  case Op::Log:
    return "log";
  case Op::Log10:
    return "log10";
  case Op::Sin:
    return "sin";
  case Op::Cos:
    return "cos";
  case Op::Tan:
    return "tan";
  case Op::Asin:
    return "asin";
  case Op::Acos:
    return "acos";
  case Op::Atan:
    return "atan";
  case Op::Atan2:
    return "atan2";
  case Op::Sinh:
    return "sinh";
  case Op::Cosh:
    return "cosh";
  case Op::Tanh:
    return "tanh";
  case Op::Abs:
    return "abs";
  case Op::Sign:
    return "sign";
  case Op::Min:
    return "min";
  case Op::Max:
    return "max";
  case Op::Floor:
    return "floor";
  case Op::Ceil:
    return "ceil";
  case Op::Select:
    return "select";
  default:
    return {};
  }
}

std::optional<int> multipliedExponent(const Graph &graph, NodeId exponent) {
  const Node &node = graph[exponent];
  if (node.op != Op::Constant || !(std::fabs(node.value) <= largestMultipliedPower) || node.value != std::floor(node.value))
    return std::nullopt;
  return static_cast<int>(node.value);
}

double integerPower(double base, int exponent) {
  double result = 1;
  bool any = false;
  for (unsigned bits = static_cast<unsigned>(std::abs(exponent)); bits != 0; bits >>= 1U) {
    if ((bits & 1U) != 0) {
      result = any ? result * base : base;
      any = true;
    }
    if (bits > 1)
      base *= base;
  }
  return exponent < 0 ? 1 / result : result;
}

double applyOperation(Op op, std::span<const double> operands) {
  const auto a = [&] { return operands[0]; };
  const auto b = [&] { return operands[1]; };
  const auto c = [&] { return operands[2]; };
  switch (op) {
  case Op::Neg:
    return -a();
  case Op::Add:
    return a() + b();
  case Op::Sub:
    return a() - b();
  case Op::Mul:
    return a() * b();
  case Op::Div:
    return a() / b();
  case Op::Pow:
    return std::pow(a(), b());
  case Op::Sqrt:
    return std::sqrt(a());
  case Op::Exp:
    return std::exp(a());
  case Op::Log:
    return std::log(a());
  case Op::Log10:
    return std::log10(a());
  case Op::Sin:
    return sineAndCosine(a()).sine;
  case Op::Cos:
    return sineAndCosine(a()).cosine;
  case Op::Tan:
    return std::tan(a());
  case Op::Asin:
    return std::asin(a());
  case Op::Acos:
    return std::acos(a());
  case Op::Atan:
    return std::atan(a());
  case Op::Atan2:
    return std::atan2(a(), b());
  case Op::Sinh:
    return std::sinh(a());
  case Op::Cosh:
    return std::cosh(a());
  case Op::Tanh:
    return std::tanh(a());
  case Op::Abs:
    return std::fabs(a());
  case Op::Sign:
    return a() > 0 ? 1 : a() < 0 ? -1 : 0;
  case Op::Min:
    return b() < a() ? b() : a();
  case Op::Max:
    return b() > a() ? b() : a();
  case Op::Floor:
    return std::floor(a());
  case Op::Ceil:
    return std::ceil(a());
  case Op::Less:
    return a() < b() ? 1 : 0;
  case Op::LessEqual:
    return a() <= b() ? 1 : 0;
  case Op::Equal:
    return a() == b() ? 1 : 0;
  case Op::And:
    return a() != 0 && b() != 0 ? 1 : 0;
  case Op::Or:
    return a() != 0 || b() != 0 ? 1 : 0;
  case Op::Not:
    return a() != 0 ? 0 : 1;
  case Op::IfElse:
    return a() != 0 ? b() : c();
  case Op::Select:
    return a() == 1 ? b() : a() == 0 ? c() : a() * b() + (1 - a()) * c();
  case Op::Constant:
  case Op::Symbol:
    break;
  }
  assert(false && "constants and symbols are not operations");
  return 0;
}

}  // namespace tf::ir
