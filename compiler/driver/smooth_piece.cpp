#include "compiler/driver/smooth_piece.h"
#include "lang/semantics/instantiate.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace tf::driver {

using flat::Base;
using flat::Expr;
using flat::ExprKind;
using flat::ExprPtr;
using flat::Function;
using flat::Operator;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool isLiteral(const ExprPtr &expression) { return expression->kind == ExprKind::Literal; }

ExprPtr literalLike(const Expr &original, std::vector<double> values) {
  auto result = std::make_shared<Expr>();
  result->type = original.type;
  result->span = original.span;
  result->values = std::move(values);
  return result;
}

ExprPtr realLiteral(double value, Span span) {
  auto result = std::make_shared<Expr>();
  result->span = span;
  result->values = {value};
  return result;
}

ExprPtr binary(Operator op, ExprPtr left, ExprPtr right) {
  auto result = std::make_shared<Expr>();
  result->kind = ExprKind::Binary;
  result->op = op;
  result->span = cover(left->span, right->span);
  result->variability = flat::Variability::Continuous;
  result->args = {std::move(left), std::move(right)};
  return result;
}

ExprPtr withArguments(const Expr &original, std::vector<ExprPtr> args) {
  auto result = std::make_shared<Expr>(original);
  result->args = std::move(args);
  return result;
}

bool isRelation(const Expr &expression) {
  return expression.kind == ExprKind::Binary && expression.op >= Operator::Less && expression.op <= Operator::NotEqual;
}

bool isDecision(const Expr &expression) {
  return isRelation(expression) || (expression.kind == ExprKind::Call && flat::hasSeams(expression.function));
}

// The largest terms that the value at a time is the sum of: what it is rounded relative to.
double magnitudeAt(const ExprPtr &expression, double time) {
  if (expression->kind == ExprKind::Unary)
    return magnitudeAt(expression->args[0], time);
  if (expression->kind == ExprKind::Binary) {
    const auto part = [&](std::size_t k) { return magnitudeAt(expression->args[k], time); };
    switch (expression->op) {
    case Operator::Plus:
    case Operator::Minus:
      return part(0) + part(1);
    case Operator::Times:
    case Operator::DotTimes:
      return part(0) * part(1);
    case Operator::Divide:
    case Operator::DotDivide:
      return part(0) / std::abs(valueAt(expression->args[1], time));
    default:
      break;
    }
  }
  return std::abs(valueAt(expression, time));
}

// Makes the decisions that hold just after a time and notes what decides them.
class Decider {
public:
  Decider(double begin, double resolution, std::vector<DecidingFunction> &deciding)
      : begin_(begin), shortest_(1e-12 * std::max(1.0, std::abs(begin))), longest_(std::max(resolution, shortest_)), deciding_(deciding) {}

  ExprPtr decide(const ExprPtr &expression) {
    if (expression->args.empty())
      return expression;
    if (expression->kind == ExprKind::If)
      return decide(expression->args[valueAt(decide(expression->args[0]), inside()) != 0 ? 1 : 2]);
    std::vector<ExprPtr> args;
    for (const ExprPtr &argument : expression->args)
      args.push_back(decide(argument));
    if (isRelation(*expression))
      return relation(*expression, args);
    return isDecision(*expression) ? call(*expression, args) : withArguments(*expression, std::move(args));
  }

private:
  // Far enough that a decision that changes at the begin has been made, near enough that none is passed over.
  [[nodiscard]] double inside() const { return begin_ + shortest_; }

  // The function's sign after the begin, which it keeps until it passes zero.
  int decideBy(const ExprPtr &function) {
    constexpr double rounding = 8 * std::numeric_limits<double>::epsilon(), growth = 4;
    const auto signOf = [](double value) { return value < 0 ? -1 : value > 0 ? 1 : 0; };
    if (isLiteral(function))
      return signOf(valueAt(function, begin_));
    for (double length = shortest_; length <= longest_; length *= growth) {
      const double time = begin_ + length, value = valueAt(function, time);
      if (std::abs(value) <= rounding * magnitudeAt(function, time))
        continue;
      deciding_.push_back({function, time});
      return signOf(value);
    }
    deciding_.push_back({function, inside()});
    return 0;
  }

  ExprPtr relation(const Expr &original, const std::vector<ExprPtr> &args) {
    const bool isOfReals = args[0]->type.base == Base::Real || args[1]->type.base == Base::Real;
    if (!isOfReals)
      return literalLike(original, {valueAt(withArguments(original, args), inside())});
    const std::vector<ExprPtr> signAndZero = {realLiteral(decideBy(binary(Operator::Minus, args[0], args[1])), original.span),
                                              realLiteral(0, original.span)};
    return literalLike(original, {valueAt(withArguments(original, signAndZero), inside())});
  }

  ExprPtr call(const Expr &original, const std::vector<ExprPtr> &args) {
    const ExprPtr &x = args[0];
    switch (original.function) {
    case Function::Abs:
      return binary(Operator::Times, realLiteral(decideBy(x) < 0 ? -1 : 1, original.span), x);
    case Function::Sign:
      return literalLike(original, {static_cast<double>(decideBy(x))});
    case Function::Min:
    case Function::Max:
      return (decideBy(binary(Operator::Minus, x, args[1])) < 0) == (original.function == Function::Min) ? x : args[1];
    case Function::Floor:
    case Function::Integer:
      return realLiteral(floorOf(x), original.span);
    case Function::Ceil:
      return realLiteral(ceilOf(x), original.span);
    case Function::Div:
      return realLiteral(truncated(quotient(args)), original.span);
    case Function::Mod:  // x - floor(x/y) y
      return binary(Operator::Minus, x, binary(Operator::Times, realLiteral(floorOf(quotient(args)), original.span), args[1]));
    default:  // rem: x - div(x, y) y
      return binary(Operator::Minus, x, binary(Operator::Times, realLiteral(truncated(quotient(args)), original.span), args[1]));
    }
  }

  static ExprPtr quotient(const std::vector<ExprPtr> &args) { return binary(Operator::Divide, args[0], args[1]); }

  int decideAgainst(const ExprPtr &x, double level) { return decideBy(binary(Operator::Minus, x, realLiteral(level, x->span))); }

  // Whole numbers that stand while x is between them and the next one.
  double floorOf(const ExprPtr &x) {
    const double nearest = std::round(valueAt(x, inside()));
    const bool isBelow = decideAgainst(x, nearest) < 0;
    decideAgainst(x, isBelow ? nearest - 1 : nearest + 1);
    return isBelow ? nearest - 1 : nearest;
  }

  double ceilOf(const ExprPtr &x) {
    const double nearest = std::round(valueAt(x, inside()));
    const bool isAbove = decideAgainst(x, nearest) > 0;
    decideAgainst(x, isAbove ? nearest + 1 : nearest - 1);
    return isAbove ? nearest + 1 : nearest;
  }

  double truncated(const ExprPtr &x) { return decideBy(x) < 0 ? ceilOf(x) : floorOf(x); }

  double begin_, shortest_, longest_;
  std::vector<DecidingFunction> &deciding_;
};

struct Affine {
  double slope, offset;
};

// The expression as slope·time + offset.
std::optional<Affine> affine(const ExprPtr &expression) {
  if (!expression->type.dims.empty())
    return std::nullopt;
  if (isLiteral(expression))
    return Affine{0, expression->values.at(0)};
  if (expression->kind == ExprKind::Time)
    return Affine{1, 0};
  const bool isOperation = expression->kind == ExprKind::Unary || expression->kind == ExprKind::Binary;
  if (!isOperation)
    return std::nullopt;
  const auto a = affine(expression->args[0]);
  const auto b = expression->args.size() > 1 ? affine(expression->args[1]) : Affine{0, 0};
  if (!a || !b)
    return std::nullopt;
  switch (expression->op) {
  case Operator::Minus:
    return expression->kind == ExprKind::Unary ? Affine{-a->slope, -a->offset} : Affine{a->slope - b->slope, a->offset - b->offset};
  case Operator::Plus:
    return Affine{a->slope + b->slope, a->offset + b->offset};
  case Operator::Times:
  case Operator::DotTimes:
    if (a->slope != 0 && b->slope != 0)
      return std::nullopt;
    return Affine{a->slope * b->offset + a->offset * b->slope, a->offset * b->offset};
  case Operator::Divide:
  case Operator::DotDivide:
    return b->slope == 0 ? std::optional(Affine{a->slope / b->offset, a->offset / b->offset}) : std::nullopt;
  default:
    return std::nullopt;
  }
}

// The longest step that samples all sines and cosines of affine arguments often enough.
double samplingStep(const ExprPtr &expression, double step) {
  constexpr double samplesPerPeriod = 32;
  if (expression->kind == ExprKind::Call && (expression->function == Function::Sin || expression->function == Function::Cos)) {
    if (const auto argument = affine(expression->args[0]); argument && argument->slope != 0)
      step = std::min(step, 2 * std::numbers::pi / (samplesPerPeriod * std::abs(argument->slope)));
  }
  for (const ExprPtr &argument : expression->args)
    step = samplingStep(argument, step);
  return step;
}

// The first double at which the sign of f(low) is left; f changes its sign between low and high.
double narrow(const ExprPtr &f, double low, double high) {
  const bool isNegative = valueAt(f, low) < 0;
  while (true) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high)
      return high;
    ((valueAt(f, middle) < 0) == isNegative ? low : high) = middle;
  }
}

// Golden section for the least |f| in [low, high], where f has one sign at both ends; a place where f has the other sign or is 0.
std::optional<double> dip(const ExprPtr &f, double low, double high) {
  const double sign = valueAt(f, low) < 0 ? -1 : 1;
  constexpr double ratio = 0.6180339887498949;
  for (int i = 0; i < 80 && high - low > 4 * std::numeric_limits<double>::epsilon() * std::abs(high); ++i) {
    const double left = high - ratio * (high - low), right = low + ratio * (high - low);
    const double atLeft = sign * valueAt(f, left), atRight = sign * valueAt(f, right);
    if (atLeft <= 0 || atRight <= 0)
      return atLeft <= 0 ? left : right;
    (atLeft < atRight ? high : low) = atLeft < atRight ? right : left;
  }
  return std::nullopt;
}

double sampledZero(const ExprPtr &f, double begin, double horizon, double step) {
  struct Sample {
    double time, value;
  };
  Sample before{begin, valueAt(f, begin)}, previous = before;
  while (previous.time < horizon) {
    const double time = std::min(previous.time + step, horizon);
    const Sample current{time, valueAt(f, time)};
    if (time <= previous.time)
      return kInfinity;
    if (previous.time > begin && previous.value == 0)
      return previous.time;
    if ((previous.value < 0 && current.value >= 0) || (previous.value > 0 && current.value <= 0))
      return narrow(f, previous.time, current.time);
    const bool isDip = std::abs(previous.value) < std::abs(before.value) && std::abs(previous.value) < std::abs(current.value);
    if (isDip) {
      if (const auto place = dip(f, before.time, current.time))
        return narrow(f, before.time, *place);
    }
    before = std::exchange(previous, current);
  }
  return kInfinity;
}

}  // namespace

ExprPtr foldParameters(const ExprPtr &expression, const std::function<double(flat::VariableId)> &parameter) {
  if (expression->kind == ExprKind::Time || isLiteral(expression))
    return expression;
  std::vector<ExprPtr> args;
  bool isConstant = true;
  for (const ExprPtr &argument : expression->args) {
    args.push_back(foldParameters(argument, parameter));
    isConstant = isConstant && args.back() && isLiteral(args.back());
    if (!args.back())
      return nullptr;
  }
  ExprPtr result = withArguments(*expression, std::move(args));
  if (!isConstant)
    return result;
  auto values = evaluate(*result, 0, [&](flat::VariableId id) { return std::optional(std::vector<double>{parameter(id)}); });
  return values ? literalLike(*expression, std::move(*values)) : nullptr;
}

double valueAt(const ExprPtr &expression, double time) {
  const auto values = evaluate(*expression, time, [](flat::VariableId) { return std::optional<std::vector<double>>(); });
  return values && values->size() == 1 ? values->front() : kNaN;
}

ExprPtr smoothPiece(const ExprPtr &expression, double begin, double resolution, std::vector<DecidingFunction> &deciding) {
  return Decider(begin, resolution, deciding).decide(expression);
}

ExprPtr arrayDecision(const ExprPtr &expression) {
  const auto isArray = [](const ExprPtr &part) { return !part->type.dims.empty(); };
  if (isDecision(*expression) && (isArray(expression) || isArray(expression->args[0])) && !isLiteral(expression))
    return expression;
  for (const ExprPtr &argument : expression->args) {
    if (ExprPtr found = arrayDecision(argument))
      return found;
  }
  return nullptr;
}

double firstZero(const ExprPtr &expression, double begin, double horizon, double resolution) {
  if (const auto line = affine(expression)) {
    const double zero = line->slope == 0 ? kInfinity : -line->offset / line->slope;
    return zero > begin && zero <= horizon ? zero : kInfinity;
  }
  return sampledZero(expression, begin, horizon, samplingStep(expression, resolution));
}

}  // namespace tf::driver
