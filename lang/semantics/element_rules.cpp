// What the attributes of elements may depend on, and how smoothly (language.md section 3, third column of the table).
#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/elements.h"

#include <algorithm>
#include <set>

namespace tf::semantics {

namespace {

using flat::Expr;
using flat::ExprKind;
using flat::Function;

enum class Quantity : std::uint8_t { Coordinate, Velocity, Acceleration, Input, Time, Result, Discrete };

std::string_view describe(Quantity quantity) {
  static constexpr std::string_view kNames[] = {"a coordinate", "a velocity", "an acceleration",    "an input",
                                                "time",         "a result",   "a discrete variable"};
  return kNames[static_cast<std::size_t>(quantity)];
}

std::string allowed(const Dependencies &may) {
  std::vector<std::string> names;
  if (may.coordinates)
    names.emplace_back("coordinates");
  if (may.velocities)
    names.emplace_back("velocities");
  if (may.states)
    names.emplace_back("states");
  if (may.inputs)
    names.emplace_back("inputs");
  if (may.time)
    names.emplace_back("time");
  names.emplace_back("parameters");
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

// Walks an expression and, behind variables with a declaration equation, their definitions.
class DependencyScan {
public:
  DependencyScan(Context &context, const AttributeSpec &spec) : context_(context), spec_(spec) {}

  // The first forbidden quantity; `where` is the outermost expression written in the attribute itself.
  const Expr *find(const Expr &expr, int derivatives, Quantity &quantity) {
    if (expr.variability <= Variability::Parameter)
      return nullptr;
    switch (expr.kind) {
    case ExprKind::Time:
      return judge(expr, Quantity::Time, quantity);
    case ExprKind::Attribute:
      return judge(expr, Quantity::Result, quantity);
    case ExprKind::Derivative:
      return find(*expr.args[0], derivatives + 1, quantity) != nullptr ? &expr : nullptr;
    case ExprKind::Variable:
      return variable(expr, derivatives, quantity);
    case ExprKind::Call:
      if (expr.function == Function::AngularVelocity)
        return find(*expr.args[0], derivatives + 1, quantity) != nullptr ? &expr : nullptr;
      [[fallthrough]];
    default:
      for (const ExprPtr &arg : expr.args)
        if (const Expr *found = find(*arg, derivatives, quantity))
          return found;
      return nullptr;
    }
  }

private:
  const Expr *variable(const Expr &expr, int derivatives, Quantity &quantity) {
    Component &component = *context_.variableOwners[static_cast<std::size_t>(expr.variable)];
    const flat::Variable &declared = context_.model.variables[static_cast<std::size_t>(expr.variable)];
    if (declared.causality == flat::Causality::Input)
      return judge(expr, Quantity::Input, quantity);
    if (declared.isAngularVelocity)
      return judge(expr, derivatives == 0 ? Quantity::Velocity : Quantity::Acceleration, quantity);
    if (declared.isCoordinate)
      return judge(expr,
                   derivatives == 0   ? Quantity::Coordinate
                   : derivatives == 1 ? Quantity::Velocity
                                      : Quantity::Acceleration,
                   quantity);
    if (!visited_.insert({&component, derivatives}).second)
      return nullptr;
    const ExprPtr definition = bindingOf(context_, component);
    if (definition == nullptr)
      return nullptr;
    return find(*definition, derivatives, quantity) != nullptr ? &expr : nullptr;
  }

  const Expr *judge(const Expr &expr, Quantity found, Quantity &quantity) {
    if (isAllowed(found))
      return nullptr;
    quantity = found;
    return &expr;
  }

  [[nodiscard]] bool isAllowed(Quantity found) const {
    switch (found) {
    case Quantity::Coordinate:
      return spec_.may.coordinates;
    case Quantity::Velocity:
      return spec_.may.velocities;
    case Quantity::Input:
      return spec_.may.inputs;
    case Quantity::Time:
      return spec_.may.time;
    case Quantity::Discrete:
      return spec_.may.states;
    case Quantity::Acceleration:
    case Quantity::Result:
      return false;
    }
    return false;
  }

  Context &context_;
  const AttributeSpec &spec_;
  std::set<std::pair<const Component *, int>> visited_;
};

bool dependsOnCoordinates(Context &context, const Expr &expr, std::set<const Component *> &visited) {
  if (expr.variability <= Variability::Parameter)
    return false;
  if (expr.kind == ExprKind::Variable) {
    const flat::Variable &variable = context.model.variables[static_cast<std::size_t>(expr.variable)];
    if (variable.isCoordinate || variable.isAngularVelocity)
      return true;
    Component &component = *context.variableOwners[static_cast<std::size_t>(expr.variable)];
    if (!visited.insert(&component).second)
      return false;
    const ExprPtr definition = bindingOf(context, component);
    return definition != nullptr && dependsOnCoordinates(context, *definition, visited);
  }
  return std::ranges::any_of(expr.args, [&](const ExprPtr &arg) { return dependsOnCoordinates(context, *arg, visited); });
}

bool isSwitching(const Expr &expr) { return expr.kind == ExprKind::If || (expr.kind == ExprKind::Call && hasSeams(expr.function)); }

bool isDeclaredSmooth(const Expr &expr) {
  return expr.kind == ExprKind::Call && expr.function == Function::Smooth && expr.args[0]->kind == ExprKind::Literal &&
         expr.args[0]->values[0] >= 2;
}

// An `if` switches with its condition, whatever its branches depend on.
bool switchesWithCoordinates(Context &context, const Expr &expr) {
  std::set<const Component *> visited;
  return isSwitching(expr) && dependsOnCoordinates(context, expr.kind == ExprKind::If ? *expr.args[0] : expr, visited);
}

// The first subexpression that switches with the coordinates and is not declared smooth.
const Expr *findKink(Context &context, const Expr &expr, std::set<const Component *> &visited) {
  if (expr.variability <= Variability::Parameter || isDeclaredSmooth(expr))
    return nullptr;
  if (switchesWithCoordinates(context, expr))
    return &expr;
  if (expr.kind == ExprKind::Variable) {
    Component &component = *context.variableOwners[static_cast<std::size_t>(expr.variable)];
    if (!visited.insert(&component).second)
      return nullptr;
    const ExprPtr definition = bindingOf(context, component);
    return definition != nullptr && findKink(context, *definition, visited) != nullptr ? &expr : nullptr;
  }
  for (const ExprPtr &arg : expr.args)
    if (const Expr *found = findKink(context, *arg, visited))
      return found;
  return nullptr;
}

// Degree of a polynomial in the velocities; 2 stands for everything that is not affine.
class VelocityDegree {
public:
  explicit VelocityDegree(Context &context) : context_(context) {}

  int of(const Expr &expr) {
    if (expr.variability <= Variability::Parameter)
      return 0;
    switch (expr.kind) {
    case ExprKind::Derivative: {
      std::set<const Component *> visited;
      return dependsOnCoordinates(context_, *expr.args[0], visited) ? 1 : 0;
    }
    case ExprKind::Variable:
      return variable(expr);
    case ExprKind::Binary:
      return binary(expr);
    case ExprKind::If:
      return std::max({2 * of(*expr.args[0]), of(*expr.args[1]), of(*expr.args[2])});
    case ExprKind::Call:
      return call(expr);
    default:
      return largest(expr);
    }
  }

private:
  int largest(const Expr &expr) {
    int degree = 0;
    for (const ExprPtr &arg : expr.args)
      degree = std::max(degree, of(*arg));
    return degree;
  }

  int binary(const Expr &expr) {
    const int left = of(*expr.args[0]), right = of(*expr.args[1]);
    switch (expr.op) {
    case flat::Operator::Plus:
    case flat::Operator::Minus:
      return std::max(left, right);
    case flat::Operator::Times:
    case flat::Operator::DotTimes:
      return std::min(left + right, 2);
    case flat::Operator::Divide:
    case flat::Operator::DotDivide:
      return right == 0 ? left : 2;
    default:
      return left + right == 0 ? 0 : 2;
    }
  }

  int call(const Expr &expr) {
    switch (expr.function) {
    case Function::Sum:
    case Function::Transpose:
    case Function::Skew:
    case Function::Diagonal:
    case Function::Scalar:
    case Function::Vector:
    case Function::Matrix:
    case Function::NoEvent:
    case Function::Smooth:
      return largest(expr);
    case Function::AngularVelocity: {
      std::set<const Component *> visited;
      return dependsOnCoordinates(context_, *expr.args[0], visited) ? 1 : 0;
    }
    case Function::Cross:
    case Function::Rotate:
    case Function::OuterProduct:
      return std::min(of(*expr.args[0]) + of(*expr.args[1]), 2);
    default:
      return largest(expr) == 0 ? 0 : 2;
    }
  }

  int variable(const Expr &expr) {
    if (context_.model.variables[static_cast<std::size_t>(expr.variable)].isAngularVelocity)
      return 1;
    Component &component = *context_.variableOwners[static_cast<std::size_t>(expr.variable)];
    const auto [entry, isNew] = known_.try_emplace(&component, 0);
    if (!isNew)
      return entry->second;
    const ExprPtr definition = bindingOf(context_, component);
    const int degree = definition == nullptr ? 0 : of(*definition);
    return known_[&component] = degree;
  }

  Context &context_;
  std::map<const Component *, int> known_;
};

}  // namespace

void checkDependencies(Context &context, const Component &element, const AttributeSpec &spec, const Expr &value, Span span) {
  Quantity quantity{};
  if (const Expr *found = DependencyScan(context, spec).find(value, 0, quantity)) {
    const std::string_view written = context.sources.text(found->span);
    if (quantity == Quantity::Result) {
      Diagnostic &error = context.diagnostics.report(diag::ResultInAttribute, found->span, written, spec.name);
      if (element.leaf->predefined->kind == PredefinedKind::Friction)
        error.message += "; use 'contact', whose friction follows its normal force";
      return;
    }
    context.diagnostics.report(diag::AttributeDependsOn, found->span, spec.name, written, describe(quantity), allowed(spec.may))
        .note(span, fmt::format("in '{}' of '{}'", spec.name, element.path));
    return;
  }
  std::set<const Component *> visited;
  if (spec.isKinematic)
    if (const Expr *kink = findKink(context, value, visited)) {
      context.diagnostics.report(diag::AttributeNotSmooth, kink->span, spec.name);
      return;
    }
  if (spec.isAffine && VelocityDegree(context).of(value) > 1)
    context.diagnostics.report(diag::AttributeNotAffine, value.span, spec.name);
}

}  // namespace tf::semantics
