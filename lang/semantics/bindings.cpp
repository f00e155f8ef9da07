// Values of declarations and modifications: typed, projected to array elements and record fields, broadcast; constant values.
#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/quotient_note.h"
#include "lang/semantics/records.h"
#include "lang/semantics/typing.h"

#include <algorithm>
#include <cassert>
#include <set>

namespace tf::semantics {

namespace {

bool isSuffix(const std::vector<int> &part, const std::vector<int> &whole) {
  return part.size() <= whole.size() && std::equal(part.rbegin(), part.rend(), whole.rbegin());
}

}  // namespace

ExprPtr typeBinding(Context &context, const Binding &binding) {
  assert(binding.expression != nullptr);
  const Scope scope{binding.scope, nullptr, false};
  if (std::ranges::any_of(binding.projections, [](const Projection &projection) { return !projection.field.empty(); }))
    return typeProjected(context, *binding.expression, scope, binding.projections);
  const auto key = std::make_pair(binding.expression, static_cast<const Class *>(binding.scope));
  const auto known = context.typedBindings.find(key);
  ExprPtr value = known != context.typedBindings.end() ? known->second : typeExpression(context, *binding.expression, scope);
  if (known == context.typedBindings.end())
    context.typedBindings.emplace(key, value);
  for (const Projection &projection : binding.projections)
    if (value != nullptr)
      value = projectIndex(context, value, projection);
  return value;
}

ExprPtr typeShapedBinding(Context &context, const Binding &binding, bool isEach, Base base, const std::vector<int> &dims,
                          std::string_view name, bool isDeclared) {
  ExprPtr value = typeBinding(context, binding);
  if (value == nullptr)
    return nullptr;
  if (!isConvertible(value->type.base, base)) {
    Diagnostic &report = context.diagnostics.report(diag::BindingType, value->span, name, toString({base, {}}), toString(value->type));
    if (base == Base::Integer)
      noteQuotient(report, *binding.expression, *value);
    return nullptr;
  }
  if (base == Base::Real)
    value = toReal(value);
  const std::vector<int> covered(dims.begin() + std::min<std::ptrdiff_t>(binding.outerDims, static_cast<std::ptrdiff_t>(dims.size())),
                                 dims.end());
  const std::vector<int> &given = value->type.dims;
  if (isEach && dims.empty() && !binding.isWithinArray)
    context.diagnostics.report(diag::EachOnScalar, binding.span, name);
  if (isEach ? !isSuffix(given, covered) : given != covered) {
    if (given.empty() && !isEach && !isDeclared)
      context.diagnostics.report(diag::ScalarWithoutEach, value->span, name, toString({base, covered}), toString(value->type));
    else
      context.diagnostics.report(diag::ShapeMismatch, value->span, name, toString({base, covered}), toString(value->type));
    return nullptr;
  }
  return broadcast(value, {dims.begin(), dims.end() - static_cast<std::ptrdiff_t>(given.size())});
}

ExprPtr bindingOf(Context &context, Component &component) {
  if (component.bindingProgress != Progress::Fresh)
    return component.binding;
  component.bindingProgress = Progress::Running;
  if (component.modifier && component.modifier->binding && component.isLeaf()) {
    const Binding &binding = *component.modifier->binding;
    const Type type = typeOf(component);
    const ast::Modification *declared = component.declaration->modification;
    component.binding = typeShapedBinding(context, binding, binding.isEach, type.base, type.dims, component.name,
                                          declared != nullptr && declared->value == binding.expression);
    component.isBindingWrong = component.binding == nullptr;
  }
  component.bindingProgress = Progress::Done;
  return component.binding;
}

namespace {

// A value given on the command line for a structural parameter; `suffix` is the element, "[2]".
std::optional<double> overrideOf(const Context &context, const Component &component, const std::string &suffix) {
  if (component.prefixes.isFinal || variabilityOf(component) != Variability::Parameter)
    return std::nullopt;
  const auto found = context.options.structuralOverrides.find(component.path + suffix);
  return found == context.options.structuralOverrides.end() ? std::nullopt : std::optional(found->second);
}

void applyOverrides(const Context &context, const Component &component, std::optional<std::vector<double>> &values) {
  if (component.dimensions.empty()) {
    if (const auto given = overrideOf(context, component, ""))
      values = std::vector<double>{*given};
    return;
  }
  if (!values || component.dimensions.size() != 1)
    return;
  for (std::size_t i = 0; i < values->size(); ++i)
    if (const auto given = overrideOf(context, component, "[" + std::to_string(i + 1) + "]"))
      (*values)[i] = *given;
}

}  // namespace

std::optional<std::vector<double>> valueOf(Context &context, Component &component) {
  assert(component.isLeaf());
  if (variabilityOf(component) > Variability::Parameter)
    return std::nullopt;
  if (component.valueProgress == Progress::Running) {
    context.diagnostics.report(diag::CyclicDefinition, component.declaration->name.span, component.path);
    return std::nullopt;
  }
  if (component.valueProgress == Progress::Fresh) {
    component.valueProgress = Progress::Running;
    const ExprPtr binding = bindingOf(context, component);
    if (binding != nullptr)
      component.value = constantValue(context, *binding);
    else if (const ModifierPtr *start = component.leaf->leafModifier ? component.leaf->leafModifier->find("start") : nullptr;
             start != nullptr && (*start)->binding) {
      const Binding &value = *(*start)->binding;
      const ExprPtr typed = typeShapedBinding(context, value, value.isEach, typeOf(component).base, component.dimensions, component.name);
      if (typed != nullptr)
        component.value = constantValue(context, *typed);
    }
    applyOverrides(context, component, component.value);
    component.valueProgress = Progress::Done;
  }
  if (component.value && variabilityOf(component) == Variability::Parameter)
    context.model.variables[static_cast<std::size_t>(variableOf(context, component))].isStructural = true;
  return component.value;
}

namespace {

// With the parameters that `mayRead` allows.
template <class Predicate> std::optional<std::vector<double>> evaluateWith(Context &context, const flat::Expr &expr, Predicate mayRead) {
  if (expr.variability > Variability::Parameter)
    return std::nullopt;
  return evaluateExpression(expr, 0, [&](const flat::Expr &reference) -> std::optional<std::vector<double>> {
    Component &component = *context.variableOwners[static_cast<std::size_t>(reference.variable)];
    if (variabilityOf(component) == Variability::Parameter && !mayRead(reference.variable))
      return std::nullopt;
    auto values = valueOf(context, component);
    if (!values || reference.indices.empty())
      return values;
    return selectValues(*values, component.dimensions, reference.indices);
  });
}

}  // namespace

std::optional<std::vector<double>> constantValue(Context &context, const flat::Expr &expr) {
  return evaluateWith(context, expr, [](flat::VariableId) { return true; });
}

namespace {

// Itself, or by the bindings of the variables that it reads.
bool readsWrongBinding(Context &context, const flat::Expr &expr, std::set<flat::VariableId> &seen) {
  if (expr.kind == flat::ExprKind::Variable && seen.insert(expr.variable).second) {
    const Component &component = *context.variableOwners[static_cast<std::size_t>(expr.variable)];
    if (component.isBindingWrong || (component.binding != nullptr && readsWrongBinding(context, *component.binding, seen)))
      return true;
  }
  return std::ranges::any_of(expr.args, [&](const ExprPtr &arg) { return arg != nullptr && readsWrongBinding(context, *arg, seen); });
}

}  // namespace

void reportNotConstant(Context &context, const flat::Expr &expr, Span span, std::string_view what) {
  std::set<flat::VariableId> seen;
  if (!readsWrongBinding(context, expr, seen))
    context.diagnostics.report(diag::NotConstant, span, what);
}

std::optional<std::vector<double>> settledValue(Context &context, const flat::Expr &expr) {
  return evaluateWith(context, expr,
                      [&](flat::VariableId id) { return context.model.variables[static_cast<std::size_t>(id)].isStructural; });
}

}  // namespace tf::semantics
