#include "lang/semantics/typing.h"

#include "lang/semantics/diagnostics.h"
#include "lang/semantics/quotient_note.h"
#include "lang/semantics/text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tf::semantics {

namespace {

flat::Operator operatorOf(ast::Operator op) {
  switch (op) {
  case ast::Operator::Plus:
  case ast::Operator::DotPlus:
    return flat::Operator::Plus;
  case ast::Operator::Minus:
  case ast::Operator::DotMinus:
    return flat::Operator::Minus;
  case ast::Operator::Times:
    return flat::Operator::Times;
  case ast::Operator::Divide:
    return flat::Operator::Divide;
  case ast::Operator::Power:
    return flat::Operator::Power;
  case ast::Operator::DotTimes:
    return flat::Operator::DotTimes;
  case ast::Operator::DotDivide:
    return flat::Operator::DotDivide;
  case ast::Operator::DotPower:
    return flat::Operator::DotPower;
  case ast::Operator::And:
    return flat::Operator::And;
  case ast::Operator::Or:
    return flat::Operator::Or;
  case ast::Operator::Not:
    return flat::Operator::Not;
  case ast::Operator::Less:
    return flat::Operator::Less;
  case ast::Operator::LessEqual:
    return flat::Operator::LessEqual;
  case ast::Operator::Greater:
    return flat::Operator::Greater;
  case ast::Operator::GreaterEqual:
    return flat::Operator::GreaterEqual;
  case ast::Operator::Equal:
    return flat::Operator::Equal;
  case ast::Operator::NotEqual:
    return flat::Operator::NotEqual;
  case ast::Operator::None:
    break;
  }
  return flat::Operator::None;
}

}  // namespace

std::unique_ptr<Typer> Typer::nested(const Locals *locals) {
  std::unique_ptr<Typer> inner = makeNested(locals);
  inner->ends_ = ends_;
  inner->scope_.isUnreached = scope_.isUnreached;
  return inner;
}

std::unique_ptr<Typer> Typer::makeNested(const Locals *locals) {
  return std::make_unique<Typer>(context_, Scope{scope_.enclosing, locals, scope_.isFunctionBody});
}

ExprPtr Typer::type(const ast::Expr &expr) {
  if (context_.isOverLimit)
    return nullptr;
  if (context_.expressionDepth >= kMaximumExpressionDepth) {
    if (!context_.isTooDeep)
      context_.diagnostics.report(diag::NestedTooDeeply, expr.span);
    context_.isTooDeep = true;
    return nullptr;
  }
  if (++context_.typedNodes > kMaximumTypedNodes) {
    context_.diagnostics.report(diag::ModelTooLarge, expr.span, kMaximumComponents);
    context_.isOverLimit = true;
    return nullptr;
  }
  ++context_.expressionDepth;
  ExprPtr result = typeUnguarded(expr);
  --context_.expressionDepth;
  return isWithinLimits(result, expr.span) ? result : nullptr;
}

bool Typer::isWithinLimits(const ExprPtr &typed, Span span) {
  if (typed == nullptr || (typed->height <= kMaximumExpressionHeight && typed->nodes <= kMaximumExpressionNodes))
    return true;
  if (!context_.isTooDeep)
    context_.diagnostics.report(diag::NestedTooDeeply, span);
  context_.isTooDeep = true;
  return false;
}

ExprPtr Typer::typeUnguarded(const ast::Expr &expr) {
  switch (expr.kind) {
  case ast::ExprKind::Integer:
    return makeInteger(expr.number, expr.span);
  case ast::ExprKind::Real:
    return makeReal(expr.number, expr.span);
  case ast::ExprKind::Boolean:
    return makeBoolean(expr.number != 0, expr.span);
  case ast::ExprKind::String:
    return makeString(unquote(expr.text), expr.span);
  case ast::ExprKind::Reference:
    return typeReference(expr.reference, expr.span);
  case ast::ExprKind::Unary: {
    const ExprPtr operand = type(*expr.operands[0]);
    return makeUnary(operatorOf(expr.op), operand, expr.span, diagnostics());
  }
  case ast::ExprKind::Binary:
    return typeBinary(expr);
  case ast::ExprKind::Range:
    return typeRange(expr);
  case ast::ExprKind::If:
    return typeIf(expr);
  case ast::ExprKind::Call:
    return call(expr);
  case ast::ExprKind::Array:
    return typeArray(expr);
  case ast::ExprKind::Matrix:
    return typeMatrix(expr);
  case ast::ExprKind::Tuple:
    if (expr.operands.size() == 1 && expr.operands[0] != nullptr)
      return type(*expr.operands[0]);
    diagnostics().report(diag::TupleOutsideCall, expr.span);
    return nullptr;
  case ast::ExprKind::Subscripted:
    return typeSubscripted(expr);
  case ast::ExprKind::End:
    return ends_.empty() ? nullptr : makeInteger(ends_.back(), expr.span);
  case ast::ExprKind::PartialFunction:
    diagnostics().report(diag::NotSupported, expr.span, "a function as an argument");
    return nullptr;
  // The parser refuses these where they have no value, and `end` outside of subscripts.
  case ast::ExprKind::Colon:
  case ast::ExprKind::ValueAt:
  case ast::ExprKind::Error:
    return nullptr;
  }
  return nullptr;
}

ExprPtr Typer::typeReference(const ast::Reference &name, Span span) {
  if (name.parts.size() == 1 && !name.leadingDot) {
    const ast::ReferencePart &part = name.parts[0];
    for (const Locals *local = scope_.locals; local != nullptr; local = local->outer)
      if (local->name == part.name.text)
        return typeLocal(*local, part, span);
    if (part.name.text == "time" && !part.hasSubscripts) {
      flat::Expr time;
      time.kind = flat::ExprKind::Time;
      time.variability = Variability::Continuous;
      time.span = span;
      return std::make_shared<const flat::Expr>(std::move(time));
    }
  }
  return reference(name, span);
}

ExprPtr Typer::typeLocal(const Locals &local, const ast::ReferencePart &part, Span span) {
  const std::vector<int> &dims = local.value != nullptr ? local.value->type.dims : local.type.dims;
  const auto chosen = selections(part.subscripts, dims, span);
  if (!chosen)
    return nullptr;
  if (local.value != nullptr)
    return makeIndex(local.value, *chosen, span);
  if (chosen->size() == dims.size() && std::ranges::all_of(*chosen, &flat::Selection::scalar) && !local.elements.empty()) {
    std::size_t offset = 0;
    for (std::size_t i = 0; i < dims.size(); ++i)
      offset = offset * static_cast<std::size_t>(dims[i]) + static_cast<std::size_t>((*chosen)[i].positions[0] - 1);
    if (local.elements[offset] != nullptr)
      return local.elements[offset];
  }
  diagnostics().report(diag::FunctionBody, span, fmt::format("'{}' is read before it has a value", part.name.text));
  return nullptr;
}

// Long sums lean to the left: their spine is walked in a loop.
ExprPtr Typer::typeBinary(const ast::Expr &expr) {
  std::vector<const ast::Expr *> spine;
  const ast::Expr *first = &expr;
  for (; first->kind == ast::ExprKind::Binary; first = first->operands[0])
    spine.push_back(first);
  ExprPtr result = type(*first);
  for (auto node = spine.rbegin(); node != spine.rend(); ++node)
    result = combine(**node, result, type(*(*node)->operands[1]));
  return result;
}

ExprPtr Typer::combine(const ast::Expr &expr, const ExprPtr &left, const ExprPtr &right) {
  if (left == nullptr || right == nullptr)
    return nullptr;
  const bool isElementwise = expr.op == ast::Operator::DotPlus || expr.op == ast::Operator::DotMinus;
  const bool isEquality = expr.op == ast::Operator::Equal || expr.op == ast::Operator::NotEqual;
  if (isEquality && !scope_.isFunctionBody && (left->type.base == Base::Real || right->type.base == Base::Real) &&
      std::max(left->variability, right->variability) > Variability::Parameter) {
    diagnostics().report(diag::RealEquality, expr.span);
    return nullptr;
  }
  return makeBinary(operatorOf(expr.op), left, right, expr.span, diagnostics(), isElementwise);
}

ExprPtr Typer::typeRange(const ast::Expr &expr) {
  std::vector<double> bounds;
  bool isInteger = true;
  for (const ast::Expr *operand : expr.operands) {
    const ExprPtr bound = type(*operand);
    if (bound == nullptr)
      return nullptr;
    if (!bound->type.dims.empty() || (!isNumeric(bound->type.base) && bound->type.base != Base::Enumeration)) {
      diagnostics().report(diag::RangeType, operand->span, toString(bound->type));
      return nullptr;
    }
    const auto value = constantValue(context_, *bound);
    if (!value) {
      reportNotConstant(context_, *bound, operand->span, "the bound of a range");
      return nullptr;
    }
    isInteger = isInteger && bound->type.base != Base::Real;
    bounds.push_back((*value)[0]);
  }
  const double start = bounds.front(), stop = bounds.back(), step = bounds.size() == 3 ? bounds[1] : 1;
  if (step == 0 || !std::isfinite(start) || !std::isfinite(stop) || !std::isfinite(step)) {
    diagnostics().report(diag::RangeStep, expr.span);
    return nullptr;
  }
  const double count = std::floor((stop - start) / step * (1 + 1e-14)) + 1;
  if (count > kMaximumArraySize) {
    diagnostics().report(diag::ArrayTooLarge, expr.span, kMaximumArraySize);
    return nullptr;
  }
  std::vector<double> values;
  const int last = count > 0 ? static_cast<int>(count) : 0;
  values.reserve(static_cast<std::size_t>(last));
  for (int i = 0; i < last; ++i)
    values.push_back(start + i * step);
  const int size = static_cast<int>(values.size());
  return makeLiteral({isInteger ? Base::Integer : Base::Real, {size}}, std::move(values), expr.span);
}

ExprPtr Typer::typeIf(const ast::Expr &expr) {
  const bool before = scope_.isUnreached;
  const auto typePart = [this](const ast::Expr &part, const Scope &scope) {
    scope_.isUnreached = scope.isUnreached;
    return type(part);
  };
  ExprPtr result = typeConditional(context_, expr, scope_, typePart, typePart);
  scope_.isUnreached = before;
  return result;
}

ExprPtr Typer::typeArray(const ast::Expr &expr) {
  if (!expr.iterators.empty())
    return typeComprehension(expr, expr.iterators.size(), scope_.locals);
  std::vector<ExprPtr> parts;
  for (const ast::Expr *operand : expr.operands)
    parts.push_back(type(*operand));
  return makeArray(std::move(parts), expr.span, diagnostics());
}

// `{e for i in r, j in s}` is {{e for i in r} for j in s} (MLS 10.4.1): the last iterator is the outermost dimension.
ExprPtr Typer::typeComprehension(const ast::Expr &expr, std::size_t level, const Locals *locals) {
  const auto inner = nested(locals);
  if (level == 0)
    return inner->type(*expr.operands[0]);
  const ast::ForIndex &index = expr.iterators[level - 1];
  const auto values = inner->iteration(index, {expr.operands[0]});
  if (!values)
    return nullptr;
  std::vector<ExprPtr> parts;
  for (const ExprPtr &value : *values) {
    const Locals bound{locals, index.name.text, value};
    parts.push_back(typeComprehension(expr, level - 1, &bound));
    if (parts.back() == nullptr)
      return nullptr;
  }
  return parts.empty() ? typeEmpty(expr, level, locals) : makeArray(std::move(parts), expr.span, diagnostics());
}

// The type of an element is that of the body for an iterator that has no value, which 1 stands for.
ExprPtr Typer::typeEmpty(const ast::Expr &expr, std::size_t level, const Locals *locals) {
  const ast::ForIndex &index = expr.iterators[level - 1];
  const ExprPtr range = index.range == nullptr ? nullptr : nested(locals)->type(*index.range);
  const Base base = range == nullptr ? Base::Integer : range->type.base;
  const Locals bound{locals, index.name.text, makeLiteral({base, {}}, {1}, expr.span)};
  const bool before = std::exchange(scope_.isUnreached, true);
  const int errors = diagnostics().errorCount();
  const ExprPtr element = typeComprehension(expr, level - 1, &bound);
  scope_.isUnreached = before;
  if (element == nullptr && diagnostics().errorCount() > errors)
    return nullptr;
  // Elements of arrays that have none are not typed: numbers, most likely.
  return makeBlank(element == nullptr ? Type{Base::Real, {}} : element->type, {0}, expr.span);
}

namespace {

// `[…]` promotes its entries to matrices (MLS 10.4.2.1).
ExprPtr promoteToMatrix(const ExprPtr &value) {
  if (value == nullptr || value->type.dims.size() >= 2)
    return value;
  std::vector<int> dims = value->type.dims;
  dims.resize(2, 1);
  if (value->kind == flat::ExprKind::Literal && value->type.base != Base::String)
    return makeLiteral({value->type.base, dims}, value->values, value->span);
  return makeCall(flat::Function::Matrix, {value->type.base, dims}, {value}, value->span);
}

}  // namespace

ExprPtr Typer::typeMatrix(const ast::Expr &expr) {
  std::vector<ExprPtr> rows;
  for (const ast::Expr *row : expr.operands) {
    std::vector<ExprPtr> columns;
    for (const ast::Expr *entry : row->operands)
      columns.push_back(entry == nullptr ? nullptr : promoteToMatrix(type(*entry)));
    const bool areScalars =
        std::ranges::all_of(columns, [](const ExprPtr &c) { return c != nullptr && c->type.dims == std::vector<int>{1, 1}; });
    if (!areScalars) {
      rows.push_back(makeConcatenation(std::move(columns), 1, row->span, diagnostics()));
      continue;
    }
    std::vector<ExprPtr> entries;
    entries.reserve(columns.size());
    for (const ExprPtr &column : columns)
      entries.push_back(column->kind == flat::ExprKind::Call ? column->args[0] : elementAt(column, {1, 1}, column->span));
    const ExprPtr line = makeArray(std::move(entries), row->span, diagnostics());
    rows.push_back(line == nullptr ? nullptr : makeArray({line}, row->span, diagnostics()));
  }
  const bool areLines = std::ranges::all_of(rows, [](const ExprPtr &r) { return r != nullptr && r->type.dims[0] == 1; });
  if (!areLines)
    return makeConcatenation(std::move(rows), 0, expr.span, diagnostics());
  for (ExprPtr &row : rows)
    row = elementAt(row, {1}, row->span);
  return makeArray(std::move(rows), expr.span, diagnostics());
}

ExprPtr Typer::typeSubscripted(const ast::Expr &expr) {
  const ExprPtr array = type(*expr.operands[0]);
  if (array == nullptr)
    return nullptr;
  const ast::List<ast::Expr *> subscripts{expr.operands.data + 1, expr.operands.count - 1};
  const auto chosen = selections(subscripts, visibleDims(array->type), expr.span);
  return chosen ? makeIndex(array, *chosen, expr.span) : nullptr;
}

std::optional<flat::Selection> Typer::selection(const ast::Expr &subscript, int size) {
  flat::Selection chosen;
  if (subscript.kind == ast::ExprKind::Colon) {
    for (int i = 1; i <= size; ++i)
      chosen.positions.push_back(i);
    return chosen;
  }
  ends_.push_back(size);
  const ExprPtr typed = type(subscript);
  ends_.pop_back();
  if (typed == nullptr)
    return std::nullopt;
  const bool isIndex = typed->type.base == Base::Integer || typed->type.base == Base::Enumeration || typed->type.base == Base::Boolean;
  if (!isIndex || typed->type.dims.size() > 1) {
    noteQuotient(diagnostics().report(diag::SubscriptType, subscript.span, toString(typed->type)), subscript, *typed);
    return std::nullopt;
  }
  const auto values = constantValue(context_, *typed);
  if (!values) {
    reportNotConstant(context_, *typed, subscript.span, "a subscript");
    return std::nullopt;
  }
  chosen.scalar = typed->type.dims.empty();
  for (const double value : *values) {
    const double position = typed->type.base == Base::Boolean ? value + 1 : value;
    // Any element tells the type of one that is not needed, be there none.
    const double needed = scope_.isUnreached ? std::clamp(position, 1.0, std::max(1.0, static_cast<double>(size))) : position;
    if (!scope_.isUnreached && (needed < 1 || needed > size)) {
      diagnostics().report(diag::SubscriptRange, subscript.span, position, size);
      return std::nullopt;
    }
    chosen.positions.push_back(static_cast<int>(needed));
  }
  return chosen;
}

std::optional<std::vector<flat::Selection>> Typer::selections(const ast::List<ast::Expr *> &subscripts, const std::vector<int> &dims,
                                                              Span span) {
  if (subscripts.size() > dims.size()) {
    diagnostics().report(diag::TooManySubscripts, span, subscripts.size(), dims.size());
    return std::nullopt;
  }
  std::vector<flat::Selection> chosen;
  for (std::size_t i = 0; i < subscripts.size(); ++i) {
    auto one = selection(*subscripts[i], dims[i]);
    if (!one)
      return std::nullopt;
    chosen.push_back(std::move(*one));
  }
  return chosen;
}

ExprPtr typeExpression(Context &context, const ast::Expr &expr, const Scope &scope) { return Typer(context, scope).type(expr); }

namespace {

bool isCondition(const flat::Expr &expr) { return expr.type == Type{Base::Boolean, {}}; }

// Integers become reals where the other type has them.
bool haveCommonBase(const Type &a, const Type &b) {
  const auto isNumber = [](const Type &type) { return type.base == Base::Real || type.base == Base::Integer; };
  return a.base == b.base || (isNumber(a) && isNumber(b));
}

}  // namespace

ExprPtr typeConditional(Context &context, const ast::Expr &expr, Scope scope, const PartTyping &typeCondition,
                        const PartTyping &typeValue) {
  Scope unreached = scope;
  unreached.isUnreached = true;
  // Conditions and the values behind them alternate; the last value is that where no condition holds.
  std::vector<ExprPtr> conditions, values, otherValues;
  bool isDecided = false;
  for (std::size_t i = 0; i < expr.operands.size(); i += 2) {
    const bool isLast = i + 1 == expr.operands.size();
    const ExprPtr condition = isLast ? nullptr : typeCondition(*expr.operands[i], isDecided ? unreached : scope);
    if (isDecided && condition != nullptr && !isCondition(*condition))
      context.diagnostics.report(diag::ConditionType, condition->span, toString(condition->type));
    const auto known = !isDecided && condition != nullptr && isCondition(*condition) ? settledValue(context, *condition) : std::nullopt;
    const bool isPassedOver = isDecided || (known && known->front() == 0);
    const ast::Expr &value = *expr.operands[isLast ? i : i + 1];
    (isPassedOver ? otherValues : values).push_back(typeValue(value, isPassedOver ? unreached : scope));
    if (!isDecided && !isLast && !known)
      conditions.push_back(condition);
    isDecided = isDecided || (known && !isPassedOver);
  }
  ExprPtr result = values.back();
  for (std::size_t k = conditions.size(); k-- > 0;)
    result = makeIf(conditions[k], values[k], result, expr.span, context.diagnostics);
  for (const ExprPtr &other : otherValues)
    if (result != nullptr && other != nullptr && !haveCommonBase(result->type, other->type)) {
      context.diagnostics.report(diag::BranchTypes, expr.span, toString(result->type), toString(other->type));
      return nullptr;
    }
  return result;
}

}  // namespace tf::semantics
