// Iterators: explicit ranges, and ranges implied by the subscripts in which the iterator stands (MLS 11.1.2).
#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/lookup.h"
#include "lang/semantics/typing.h"

namespace tf::semantics {

namespace {

// The array reference and position in which `name` is a subscript, e.g. x[2, i].
struct ImpliedRange {
  const ast::Reference *reference = nullptr;
  std::size_t part = 0, subscript = 0;
};

bool findUse(const ast::Expr *expr, std::string_view name, ImpliedRange &use);

bool findInReference(const ast::Reference &reference, std::string_view name, ImpliedRange &use) {
  for (std::size_t p = 0; p < reference.parts.size(); ++p)
    for (std::size_t s = 0; s < reference.parts[p].subscripts.size(); ++s) {
      const ast::Expr *subscript = reference.parts[p].subscripts[s];
      if (subscript->kind == ast::ExprKind::Reference && subscript->reference.parts.size() == 1 &&
          subscript->reference.parts[0].name.text == name) {
        use = {&reference, p, s};
        return true;
      }
      if (findUse(subscript, name, use))
        return true;
    }
  return false;
}

bool findUse(const ast::Expr *expr, std::string_view name, ImpliedRange &use) {
  if (expr == nullptr)
    return false;
  if (findInReference(expr->reference, name, use))
    return true;
  for (const ast::Expr *operand : expr->operands)
    if (findUse(operand, name, use))
      return true;
  for (const ast::NamedArgument &argument : expr->named)
    if (findUse(argument.value, name, use))
      return true;
  return false;
}

std::vector<ExprPtr> literals(const ExprPtr &range, Base base, const std::vector<double> &values) {
  std::vector<ExprPtr> result;
  result.reserve(values.size());
  for (const double value : values)
    result.push_back(makeLiteral({base, {}}, {value}, range->span));
  return result;
}

}  // namespace

std::optional<std::vector<ExprPtr>> Typer::iteration(const ast::ForIndex &index, const std::vector<const ast::Expr *> &bodies) {
  if (index.range != nullptr) {
    const ExprPtr range = type(*index.range);
    if (range == nullptr)
      return std::nullopt;
    if (range->type.dims.size() != 1) {
      diagnostics().report(diag::IterationType, index.range->span, toString(range->type));
      return std::nullopt;
    }
    const auto values = constantValue(context_, *range);
    if (!values) {
      reportNotConstant(context_, *range, index.range->span, "the range of an iterator");
      return std::nullopt;
    }
    return literals(range, range->type.base, *values);
  }
  ImpliedRange use;
  for (const ast::Expr *body : bodies)
    if (findUse(body, index.name.text, use))
      break;
  if (use.reference != nullptr && use.part == 0) {
    const Found found = lookupSimple(context_, *scope_.enclosing, use.reference->parts[0].name.text, Files::Ignore);
    Component *component = found.component == nullptr ? nullptr : actual(context_, *found.component);
    if (component != nullptr && resolve(context_, *component) && use.subscript < component->dimensions.size()) {
      std::vector<ExprPtr> result;
      for (int i = 1; i <= component->dimensions[use.subscript]; ++i)
        result.push_back(makeInteger(i, index.name.span));
      return result;
    }
  }
  diagnostics().report(diag::RangeNotImplied, index.name.span, index.name.text);
  return std::nullopt;
}

bool Typer::unroll(const ast::List<ast::ForIndex> &iterators, const std::vector<const ast::Expr *> &bodies,
                   const std::function<bool(const Locals *)> &body) {
  return unrollLevel(iterators, 0, scope_.locals, bodies, body);
}

bool Typer::unrollLevel(const ast::List<ast::ForIndex> &iterators, std::size_t level, const Locals *locals,
                        const std::vector<const ast::Expr *> &bodies, const std::function<bool(const Locals *)> &body) {
  if (level == iterators.size())
    return body(locals);
  const auto values = nested(locals)->iteration(iterators[level], bodies);
  if (!values)
    return false;
  for (const ExprPtr &value : *values) {
    const Locals bound{locals, iterators[level].name.text, value};
    if (!unrollLevel(iterators, level + 1, &bound, bodies, body))
      return false;
  }
  return true;
}

}  // namespace tf::semantics
