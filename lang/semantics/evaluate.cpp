// Values of expressions whose variables are known (`--set`, structural parameters, attributes).
#include "lang/base/trigonometry.h"
#include "lang/semantics/expressions.h"
#include "lang/semantics/instantiate.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace tf {

namespace {

using flat::Expr;
using flat::ExprKind;
using flat::Function;
using flat::Operator;
using Values = std::vector<double>;
using MaybeValues = std::optional<Values>;
using semantics::sizeOf;

double quotient(double a, double b) { return std::trunc(a / b); }

double relation(Operator op, double a, double b) {
  switch (op) {
  case Operator::Less:
    return a < b ? 1 : 0;
  case Operator::LessEqual:
    return a <= b ? 1 : 0;
  case Operator::Greater:
    return a > b ? 1 : 0;
  case Operator::GreaterEqual:
    return a >= b ? 1 : 0;
  case Operator::Equal:
    return a == b ? 1 : 0;
  default:
    return a != b ? 1 : 0;
  }
}

double scalarBinary(Operator op, double a, double b) {
  switch (op) {
  case Operator::Plus:
    return a + b;
  case Operator::Minus:
    return a - b;
  case Operator::Times:
  case Operator::DotTimes:
    return a * b;
  case Operator::Divide:
  case Operator::DotDivide:
    return a / b;
  case Operator::Power:
  case Operator::DotPower:
    return std::pow(a, b);
  case Operator::And:
    return a != 0 && b != 0 ? 1 : 0;
  case Operator::Or:
    return a != 0 || b != 0 ? 1 : 0;
  default:
    return relation(op, a, b);
  }
}

double scalarFunction(Function function, double x, double y) {
  switch (function) {
  case Function::Abs:
    return std::abs(x);
  case Function::Sign:
    return x > 0 ? 1 : x < 0 ? -1 : 0;
  case Function::Sqrt:
    return std::sqrt(x);
  case Function::Sin:
    return sineAndCosine(x).sine;
  case Function::Cos:
    return sineAndCosine(x).cosine;
  case Function::Tan:
    return std::tan(x);
  case Function::Asin:
    return std::asin(x);
  case Function::Acos:
    return std::acos(x);
  case Function::Atan:
    return std::atan(x);
  case Function::Atan2:
    return std::atan2(x, y);
  case Function::Sinh:
    return std::sinh(x);
  case Function::Cosh:
    return std::cosh(x);
  case Function::Tanh:
    return std::tanh(x);
  case Function::Exp:
    return std::exp(x);
  case Function::Log:
    return std::log(x);
  case Function::Log10:
    return std::log10(x);
  case Function::Div:
    return quotient(x, y);
  case Function::Mod:
    return x - std::floor(x / y) * y;
  case Function::Rem:
    return x - quotient(x, y) * y;
  case Function::Floor:
  case Function::Integer:
    return std::floor(x);
  case Function::Ceil:
    return std::ceil(x);
  case Function::Min:
    return std::min(x, y);
  case Function::Max:
    return std::max(x, y);
  default:
    return std::nan("");
  }
}

bool isScalarFunction(Function function) { return function <= Function::Max; }

class Evaluator {
public:
  Evaluator(double time, const semantics::VariableValues &variable) : time_(time), variable_(variable) {}

  MaybeValues value(const Expr &expr) {
    switch (expr.kind) {
    case ExprKind::Literal:
      if (expr.type.base == flat::Base::String)
        return std::nullopt;
      return expr.values;
    case ExprKind::Variable:
      return variable_(expr);
    case ExprKind::Time:
      return Values{time_};
    case ExprKind::Unary:
      return unary(expr);
    case ExprKind::Binary:
      return binary(expr);
    case ExprKind::If: {
      const MaybeValues condition = value(*expr.args[0]);
      if (!condition)
        return std::nullopt;
      return value(*expr.args[(*condition)[0] != 0 ? 1 : 2]);
    }
    case ExprKind::Call:
      return call(expr);
    case ExprKind::Array:
      return stack(expr);
    case ExprKind::Concatenate:
      return concatenate(expr);
    case ExprKind::Index: {
      const MaybeValues values = value(*expr.args[0]);
      return values ? MaybeValues(semantics::selectValues(*values, expr.args[0]->type.dims, expr.indices)) : std::nullopt;
    }
    case ExprKind::Attribute:
    case ExprKind::Derivative:
      return std::nullopt;
    }
    return std::nullopt;
  }

private:
  MaybeValues unary(const Expr &expr) {
    MaybeValues values = value(*expr.args[0]);
    if (values)
      for (double &entry : *values)
        entry = expr.op == Operator::Not ? (entry == 0 ? 1 : 0) : -entry;
    return values;
  }

  MaybeValues binary(const Expr &expr) {
    MaybeValues left = value(*expr.args[0]);
    if (!left)
      return std::nullopt;
    if (expr.type.dims.empty() && ((expr.op == Operator::And && (*left)[0] == 0) || (expr.op == Operator::Or && (*left)[0] != 0)))
      return left;
    const MaybeValues right = value(*expr.args[1]);
    if (!right)
      return std::nullopt;
    const std::vector<int> &a = expr.args[0]->type.dims, &b = expr.args[1]->type.dims;
    if (expr.op == Operator::Times && !a.empty() && !b.empty())
      return product(*left, *right, a.back());
    Values result(static_cast<std::size_t>(sizeOf(expr.type.dims)));
    for (std::size_t i = 0; i < result.size(); ++i)
      result[i] = scalarBinary(expr.op, (*left)[a.empty() ? 0 : i], (*right)[b.empty() ? 0 : i]);
    return result;
  }

  // (rows x inner)·(inner x columns); vectors are rows on the left, columns on the right.
  static Values product(const Values &left, const Values &right, int innerSize) {
    const auto inner = static_cast<std::size_t>(innerSize);
    if (inner == 0)
      return Values{0};
    const std::size_t rows = left.size() / inner, columns = right.size() / inner;
    Values result(rows * columns, 0.0);
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < columns; ++j)
        for (std::size_t k = 0; k < inner; ++k)
          result[i * columns + j] += left[i * inner + k] * right[k * columns + j];
    return result;
  }

  MaybeValues stack(const Expr &expr) {
    Values result;
    for (const flat::ExprPtr &arg : expr.args) {
      const MaybeValues part = value(*arg);
      if (!part)
        return std::nullopt;
      result.insert(result.end(), part->begin(), part->end());
    }
    return result;
  }

  MaybeValues concatenate(const Expr &expr) {
    const auto axis = static_cast<std::size_t>(expr.axis);
    const int outer = sizeOf({expr.type.dims.begin(), expr.type.dims.begin() + expr.axis});
    std::vector<Values> parts;
    for (const flat::ExprPtr &arg : expr.args) {
      MaybeValues part = value(*arg);
      if (!part)
        return std::nullopt;
      parts.push_back(std::move(*part));
    }
    Values result;
    for (int i = 0; i < outer; ++i)
      for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::vector<int> &dims = expr.args[p]->type.dims;
        const int block = sizeOf({dims.begin() + static_cast<std::ptrdiff_t>(axis), dims.end()});
        result.insert(result.end(), parts[p].begin() + i * block, parts[p].begin() + (i + 1) * block);
      }
    return result;
  }

  MaybeValues call(const Expr &expr) {
    std::vector<Values> args;
    for (const flat::ExprPtr &arg : expr.args) {
      MaybeValues entry = value(*arg);
      if (!entry)
        return std::nullopt;
      args.push_back(std::move(*entry));
    }
    if (isScalarFunction(expr.function)) {
      Values result = args[0];
      for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = scalarFunction(expr.function, args[0][i], args.size() < 2 ? 0.0 : args[1][args[1].size() == 1 ? 0 : i]);
      return result;
    }
    return arrayCall(expr, args);
  }

  static MaybeValues arrayCall(const Expr &expr, const std::vector<Values> &args) {
    switch (expr.function) {
    case Function::Sum:
      return Values{std::accumulate(args[0].begin(), args[0].end(), 0.0)};
    case Function::Product:
      return Values{std::accumulate(args[0].begin(), args[0].end(), 1.0, std::multiplies<>())};
    case Function::Transpose:
      return transpose(args[0], expr.type.dims);
    case Function::Cross:
      return Values{args[0][1] * args[1][2] - args[0][2] * args[1][1], args[0][2] * args[1][0] - args[0][0] * args[1][2],
                    args[0][0] * args[1][1] - args[0][1] * args[1][0]};
    case Function::Skew:
      return Values{0, -args[0][2], args[0][1], args[0][2], 0, -args[0][0], -args[0][1], args[0][0], 0};
    case Function::Diagonal: {
      const std::size_t n = args[0].size();
      Values result(n * n, 0.0);
      for (std::size_t i = 0; i < n; ++i)
        result[i * n + i] = args[0][i];
      return result;
    }
    case Function::OuterProduct: {
      Values result;
      for (const double a : args[0])
        for (const double b : args[1])
          result.push_back(a * b);
      return result;
    }
    case Function::Symmetric: {
      const auto n = static_cast<std::size_t>(expr.type.dims[0]);
      Values result = args[0];
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < i; ++j)
          result[i * n + j] = args[0][j * n + i];
      return result;
    }
    case Function::Scalar:
    case Function::Vector:
    case Function::Matrix:
    case Function::NoEvent:
      return args[0];
    case Function::Smooth:
      return args[1];
    case Function::Initial:
    case Function::Terminal:
      return Values{0};
    default:
      return std::nullopt;
    }
  }

  static Values transpose(const Values &values, const std::vector<int> &dims) {
    Values result;
    const auto rows = static_cast<std::size_t>(dims[0]), columns = static_cast<std::size_t>(dims[1]);
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < columns; ++j)
        result.push_back(values[j * rows + i]);
    return result;
  }

  double time_;
  const semantics::VariableValues &variable_;
};

}  // namespace

std::optional<std::vector<double>> semantics::evaluateExpression(const flat::Expr &expression, double time,
                                                                 const VariableValues &variable) {
  return Evaluator(time, variable).value(expression);
}

std::optional<std::vector<double>> evaluate(const flat::Expr &expression, double time,
                                            const std::function<std::optional<std::vector<double>>(flat::VariableId)> &variable) {
  return semantics::evaluateExpression(expression, time, [&](const Expr &reference) -> MaybeValues {
    MaybeValues values = variable(reference.variable);
    if (!values || reference.indices.empty())
      return values;
    // A reference does not carry its variable's dimensions: only vectors can be selected from.
    if (reference.indices.size() > 1)
      return std::nullopt;
    return semantics::selectValues(*values, {static_cast<int>(values->size())}, reference.indices);
  });
}

}  // namespace tf
