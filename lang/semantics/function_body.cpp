#include "lang/semantics/function_body.h"

#include "lang/semantics/diagnostics.h"
#include "lang/semantics/lookup.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace tf::semantics {

namespace {

constexpr long kMaximumSteps = 200'000;  // statements executed per call

// Row-major elements as an array.
ExprPtr compose(const std::vector<ExprPtr> &elements, std::size_t &next, const std::vector<int> &dims, std::size_t level, Span span,
                Diagnostics &diagnostics) {
  if (level == dims.size())
    return elements[next++];
  std::vector<ExprPtr> parts;
  parts.reserve(dims[level] > 0 ? static_cast<std::size_t>(dims[level]) : 0);
  for (int i = 0; i < dims[level]; ++i)
    parts.push_back(compose(elements, next, dims, level + 1, span, diagnostics));
  return makeArray(std::move(parts), span, diagnostics);
}

}  // namespace

void FunctionBody::declare(std::string_view name, Type type, ExprPtr value) {
  const Locals *outer = top();
  Locals &variable = variables_.emplace_back();
  variable.outer = outer;
  variable.name = name;
  variable.value = std::move(value);
  variable.type = std::move(type);
}

Locals *FunctionBody::find(std::string_view name) {
  const auto found = std::ranges::find(variables_, name, &Locals::name);
  return found == variables_.end() ? nullptr : &*found;
}

ExprPtr FunctionBody::value(std::string_view name) const {
  const auto found = std::ranges::find(variables_, name, &Locals::name);
  return found == variables_.end() ? nullptr : found->value;
}

const Type &FunctionBody::typeOf(std::string_view name) const {
  const auto found = std::ranges::find(variables_, name, &Locals::name);
  assert(found != variables_.end());
  return found->type;
}

bool FunctionBody::run() { return runSections(function_) != Flow::Error; }

FunctionBody::Flow FunctionBody::runSections(Class &scope) {
  for (Class *base : scope.bases)
    if (const Flow flow = runSections(*base); flow != Flow::Next)
      return flow;
  if (scope.definition == nullptr)
    return Flow::Next;
  scope_ = &scope;
  for (const ast::Section &section : scope.definition->sections) {
    if (section.kind != ast::SectionKind::Algorithm)
      return fail(section.span, "there can be no equations");
    if (const Flow flow = runAll(section.statements, top()); flow != Flow::Next)
      return flow;
  }
  return Flow::Next;
}

FunctionBody::Flow FunctionBody::fail(Span span, std::string_view what) {
  context_.diagnostics.report(diag::FunctionBody, span, what);
  return Flow::Error;
}

ExprPtr FunctionBody::type(const ast::Expr &expr, const Locals *iterators) { return Typer(context_, scopeWith(iterators)).type(expr); }

std::optional<bool> FunctionBody::known(const flat::Expr &condition) {
  const auto value =
      condition.variability <= Variability::Constant ? constantValue(context_, condition) : settledValue(context_, condition);
  return value ? std::optional(value->front() != 0) : std::nullopt;
}

std::optional<bool> FunctionBody::settled(const flat::Expr &condition) {
  const auto value = constantValue(context_, condition);
  return value ? std::optional(value->front() != 0) : std::nullopt;
}

bool FunctionBody::isOverLimit(Span span) {
  if (++steps_ <= kMaximumSteps && !context_.isOverLimit)
    return false;
  fail(span, "the loop does not end, or is too long to be unrolled,");
  return true;
}

FunctionBody::Flow FunctionBody::runAll(const ast::List<ast::Statement *> &statements, const Locals *iterators) {
  for (const ast::Statement *statement : statements) {
    if (statement == nullptr)
      return Flow::Error;
    const Flow flow = runStatement(*statement, iterators);
    if (flow != Flow::Next)
      return flow;
  }
  return Flow::Next;
}

FunctionBody::Flow FunctionBody::runStatement(const ast::Statement &statement, const Locals *iterators) {
  if (isOverLimit(statement.span))
    return Flow::Error;
  switch (statement.kind) {
  case ast::StatementKind::Assignment: {
    const ExprPtr value = statement.right == nullptr ? nullptr : type(*statement.right, iterators);
    return value == nullptr || statement.left == nullptr ? Flow::Error : assign(*statement.left, value, iterators);
  }
  case ast::StatementKind::MultiAssignment:
    return assignOutputs(statement, iterators);
  case ast::StatementKind::Call:
    return runCall(statement, iterators);
  case ast::StatementKind::If:
    return runIf(statement, 0, iterators);
  case ast::StatementKind::For:
    return runFor(statement, 0, iterators);
  case ast::StatementKind::While:
    return runWhile(statement, iterators);
  case ast::StatementKind::When:
    return fail(statement.span, "there can be no 'when'");
  case ast::StatementKind::Break:
    return Flow::Break;
  case ast::StatementKind::Return:
    return Flow::Return;
  case ast::StatementKind::Error:
    return Flow::Error;
  }
  return Flow::Error;
}

FunctionBody::Flow FunctionBody::runIf(const ast::Statement &statement, std::size_t branch, const Locals *iterators) {
  if (branch == statement.branches.size())
    return Flow::Next;
  const auto &taken = statement.branches[branch];
  if (taken.condition == nullptr)
    return runAll(taken.body, iterators);
  const ExprPtr condition = type(*taken.condition, iterators);
  if (condition == nullptr)
    return Flow::Error;
  if (condition->type != Type{Base::Boolean, {}}) {
    context_.diagnostics.report(diag::ConditionType, taken.condition->span, toString(condition->type));
    return Flow::Error;
  }
  if (const auto value = known(*condition))
    return *value ? runAll(taken.body, iterators) : runIf(statement, branch + 1, iterators);
  return joinBranches(statement, branch, condition, iterators);
}

// Executes this branch and the rest from the same values; a variable that differs becomes an if-expression.
FunctionBody::Flow FunctionBody::joinBranches(const ast::Statement &statement, std::size_t branch, const ExprPtr &condition,
                                              const Locals *iterators) {
  const auto snapshot = [&] {
    std::vector<std::pair<ExprPtr, std::vector<ExprPtr>>> values;
    values.reserve(variables_.size());
    for (const Locals &variable : variables_)
      values.emplace_back(variable.value, variable.elements);
    return values;
  };
  const auto before = snapshot();
  const Flow thenFlow = runAll(statement.branches[branch].body, iterators);
  const auto after = snapshot();
  for (std::size_t i = 0; i < before.size(); ++i)
    std::tie(variables_[i].value, variables_[i].elements) = before[i];
  const Flow elseFlow = thenFlow == Flow::Error ? Flow::Error : runIf(statement, branch + 1, iterators);
  if (thenFlow == Flow::Error || elseFlow == Flow::Error)
    return Flow::Error;
  if (thenFlow != Flow::Next || elseFlow != Flow::Next)
    return fail(statement.span, "'break' and 'return' cannot depend on a condition that is not known when the model is compiled,");
  const auto join = [&](const ExprPtr &a, const ExprPtr &b) -> ExprPtr {
    if (a == b || a == nullptr || b == nullptr)
      return a == b ? a : nullptr;
    return makeIf(condition, a, b, statement.span, context_.diagnostics);
  };
  for (std::size_t i = 0; i < after.size(); ++i) {
    Locals &variable = variables_[i];
    variable.value = join(after[i].first, variable.value);
    for (std::size_t k = 0; k < variable.elements.size(); ++k)
      variable.elements[k] = k < after[i].second.size() ? join(after[i].second[k], variable.elements[k]) : nullptr;
  }
  return Flow::Next;
}

FunctionBody::Flow FunctionBody::runFor(const ast::Statement &statement, std::size_t level, const Locals *iterators) {
  if (level == statement.iterators.size())
    return runAll(statement.body, iterators);
  const ast::ForIndex &index = statement.iterators[level];
  const auto values = Typer(context_, scopeWith(iterators)).iteration(index, {});
  if (!values)
    return Flow::Error;
  for (const ExprPtr &value : *values) {
    const Locals bound{iterators, index.name.text, value};
    const Flow flow = runFor(statement, level + 1, &bound);
    if (flow == Flow::Break)
      return level == 0 ? Flow::Next : Flow::Break;
    if (flow != Flow::Next)
      return flow;
  }
  return Flow::Next;
}

FunctionBody::Flow FunctionBody::runWhile(const ast::Statement &statement, const Locals *iterators) {
  for (;;) {
    if (isOverLimit(statement.span) || statement.condition == nullptr)
      return Flow::Error;
    const ExprPtr condition = type(*statement.condition, iterators);
    if (condition == nullptr)
      return Flow::Error;
    const auto value = settled(*condition);
    if (!value)
      return fail(statement.condition->span, "the condition of 'while' must be known when the model is compiled,");
    if (!*value)
      return Flow::Next;
    const Flow flow = runAll(statement.body, iterators);
    if (flow == Flow::Break)
      return Flow::Next;
    if (flow != Flow::Next)
      return flow;
  }
}

// `assert` with a condition that is known; other calls have no effect that could be kept.
FunctionBody::Flow FunctionBody::runCall(const ast::Statement &statement, const Locals *iterators) {
  const ast::Expr *call = statement.right;
  if (call == nullptr || call->reference.parts.empty())
    return Flow::Error;
  if (call->reference.parts[0].name.text != "assert" || call->operands.empty())
    return fail(statement.span, "a call without a result is not supported");
  const ExprPtr condition = type(*call->operands[0], iterators);
  if (condition == nullptr)
    return Flow::Error;
  const auto value = known(*condition);
  if (!value)
    return fail(call->operands[0]->span, "the condition of 'assert' must be known when the model is compiled,");
  return *value ? Flow::Next : fail(call->span, "an assertion fails");
}

FunctionBody::Flow FunctionBody::assignOutputs(const ast::Statement &statement, const Locals *iterators) {
  if (statement.left == nullptr || statement.right == nullptr)
    return Flow::Error;
  Typer typer(context_, scopeWith(iterators));
  Class *function = calledFunction(typer, *statement.right);
  if (function == nullptr) {
    context_.diagnostics.report(diag::TupleOutsideCall, statement.left->span);
    return Flow::Error;
  }
  const auto outputs = typeFunctionOutputs(typer, *function, *statement.right);
  if (!outputs)
    return Flow::Error;
  if (outputs->size() < statement.left->operands.size()) {
    context_.diagnostics.report(diag::OutputCount, statement.left->span, statement.left->operands.size(), outputs->size());
    return Flow::Error;
  }
  for (std::size_t i = 0; i < statement.left->operands.size(); ++i)
    if (const ast::Expr *target = statement.left->operands[i]; target != nullptr && assign(*target, (*outputs)[i], iterators) != Flow::Next)
      return Flow::Error;
  return Flow::Next;
}

FunctionBody::Flow FunctionBody::assign(const ast::Expr &target, const ExprPtr &given, const Locals *iterators) {
  const bool isName = target.kind == ast::ExprKind::Reference && target.reference.parts.size() == 1;
  Locals *variable = isName ? find(target.reference.parts[0].name.text) : nullptr;
  if (variable == nullptr) {
    if (!isName || lookupSimple(context_, *scope_, target.reference.parts[0].name.text, Files::Ignore))
      return fail(target.span, "this cannot be assigned to");
    const ast::Name &name = target.reference.parts[0].name;
    std::vector<std::string> names;
    std::ranges::transform(variables_, std::back_inserter(names), [](const Locals &local) { return std::string(local.name); });
    context_.diagnostics.report(diag::UnknownName, name.span, name.text).suggest(name.text, names);
    return Flow::Error;
  }
  const ExprPtr value = variable->type.base == Base::Real ? toReal(given) : given;
  const auto chosen =
      Typer(context_, scopeWith(iterators)).selections(target.reference.parts[0].subscripts, variable->type.dims, target.span);
  if (!chosen)
    return Flow::Error;
  std::vector<int> dims;
  for (std::size_t i = 0; i < variable->type.dims.size(); ++i)
    if (i >= chosen->size() || !(*chosen)[i].scalar)
      dims.push_back(i < chosen->size() ? static_cast<int>((*chosen)[i].positions.size()) : variable->type.dims[i]);
  if (value->type != Type{variable->type.base, dims}) {
    context_.diagnostics.report(diag::BindingType, given->span, variable->name, toString({variable->type.base, dims}),
                                toString(given->type));
    return Flow::Error;
  }
  if (chosen->empty()) {
    variable->value = value;
    variable->elements.clear();
    return Flow::Next;
  }
  if (variable->elements.empty())
    variable->elements = variable->value != nullptr ? scalars(variable->value, target.span)
                                                    : std::vector<ExprPtr>(static_cast<std::size_t>(sizeOf(variable->type.dims)));
  std::vector<double> positions(variable->elements.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] = static_cast<double>(i);
  std::vector<flat::Selection> full = *chosen;
  for (std::size_t i = full.size(); i < variable->type.dims.size(); ++i) {
    flat::Selection &all = full.emplace_back();
    for (int k = 1; k <= variable->type.dims[i]; ++k)
      all.positions.push_back(k);
  }
  const std::vector<ExprPtr> parts = scalars(value, target.span);
  const std::vector<double> places = selectValues(positions, variable->type.dims, full);
  for (std::size_t i = 0; i < places.size(); ++i)
    variable->elements[static_cast<std::size_t>(places[i])] = parts[i];
  const bool isComplete = std::ranges::none_of(variable->elements, [](const ExprPtr &element) { return element == nullptr; });
  std::size_t next = 0;
  variable->value = isComplete ? compose(variable->elements, next, variable->type.dims, 0, target.span, context_.diagnostics) : nullptr;
  return Flow::Next;
}

}  // namespace tf::semantics
