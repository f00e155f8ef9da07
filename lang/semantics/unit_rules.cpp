// Units that clash are warned about: sums, relations, branches, equations, declarations. Literals, the time and variables
// without a unit take any.
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/flatten.h"
#include "lang/semantics/units.h"

#include <algorithm>
#include <map>
#include <unordered_map>

namespace tf::semantics {

namespace {

using flat::Expr;
using flat::ExprKind;
using flat::ExprPtr;
using flat::Function;
using flat::Operator;

// A unit with the text to show; nothing: any.
struct Inferred {
  Unit unit;
  std::string text;
};
using MaybeUnit = std::optional<Inferred>;

class UnitInference {
public:
  UnitInference(const flat::FlatModel &model, Diagnostics &diagnostics)
      : model_(model), diagnostics_(diagnostics), units_(model.variables.size()), isKnown_(model.variables.size(), false) {}

  void run() {
    for (const flat::Variable &variable : model_.variables)
      checkVariable(variable);
    for (const flat::Element &element : model_.elements)
      for (const flat::Attribute &attribute : element.attributes)
        checkAttribute(element, attribute);
    for (const flat::Equation &equation : model_.equations)
      unify(of(equation.left), of(equation.right), equation.span);
    for (const flat::Assertion &assertion : model_.assertions)
      of(assertion.condition);
  }

private:
  void checkVariable(const flat::Variable &variable) {
    for (const std::string *text : {&variable.attributes.unit, &variable.derAttributes.unit})
      if (!text->empty() && !parseUnit(*text))
        diagnostics_.report(diag::UnitUnknown, variable.span, *text);
    if (variable.binding != nullptr)
      unify(declared(variable.attributes.unit), of(variable.binding), variable.binding->span);
  }

  void checkAttribute(const flat::Element &element, const flat::Attribute &attribute) {
    const auto kind = static_cast<PredefinedKind>(static_cast<int>(PredefinedKind::Body) + static_cast<int>(element.kind));
    for (const PredefinedClass &predefined : predefinedClasses()) {
      const AttributeSpec *spec = predefined.kind == kind ? predefined.attribute(attribute.name) : nullptr;
      if (spec == nullptr)
        continue;
      const MaybeUnit given = of(attribute.value);
      if (!spec->unit.empty())
        unify(declared(spec->unit), given, attribute.span);
    }
  }

  static MaybeUnit declared(std::string_view text) {
    const std::optional<Unit> unit = parseUnit(text);
    return text.empty() || !unit ? std::nullopt : std::optional(Inferred{*unit, std::string(text)});
  }

  MaybeUnit unify(const MaybeUnit &a, const MaybeUnit &b, Span span) {
    if (a && b && !a->unit.isSame(b->unit)) {
      diagnostics_.report(diag::UnitClash, span, a->text, b->text);
      return std::nullopt;
    }
    return a ? a : b;
  }

  MaybeUnit of(const ExprPtr &expr) {
    // Expressions of such a height (long generated sums) are not checked: the walk recurses.
    constexpr int kMaximumCheckedHeight = 300;
    if (expr->height > kMaximumCheckedHeight)
      return std::nullopt;
    const auto known = done_.find(expr.get());
    if (known != done_.end())
      return known->second;
    const MaybeUnit unit = infer(*expr);
    done_[expr.get()] = unit;
    return unit;
  }

  MaybeUnit infer(const Expr &expr) {
    switch (expr.kind) {
    case ExprKind::Literal:
    case ExprKind::Attribute:
    case ExprKind::Time:
      return std::nullopt;
    case ExprKind::Variable:
      return ofVariable(expr.variable);
    case ExprKind::Unary:
    case ExprKind::Index:
      return of(expr.args[0]);
    case ExprKind::Binary:
      return binary(expr);
    case ExprKind::If:
      of(expr.args[0]);
      return unify(of(expr.args[1]), of(expr.args[2]), expr.span);
    case ExprKind::Call:
      return call(expr);
    case ExprKind::Array:
    case ExprKind::Concatenate:
      return common(expr);
    case ExprKind::Derivative:
      return derivative(*expr.args[0]);
    }
    return std::nullopt;
  }

  // Elements of an array may differ; then the array as a whole has no unit.
  MaybeUnit common(const Expr &expr) {
    MaybeUnit result;
    bool isCommon = true;
    for (const ExprPtr &arg : expr.args) {
      const MaybeUnit unit = of(arg);
      if (unit && result && !unit->unit.isSame(result->unit))
        isCommon = false;
      if (unit)
        result = unit;
    }
    return isCommon ? result : std::nullopt;
  }

  MaybeUnit ofVariable(flat::VariableId id) {
    const auto at = static_cast<std::size_t>(id);
    const flat::Variable &variable = model_.variables[at];
    if (!variable.attributes.unit.empty() || variable.binding == nullptr)
      return declared(variable.attributes.unit);
    if (isKnown_[at])
      return units_[at];
    isKnown_[at] = true;
    return units_[at] = of(variable.binding);
  }

  MaybeUnit derivative(const Expr &operand) {
    if (operand.kind == ExprKind::Variable)
      if (const auto &unit = model_.variables[static_cast<std::size_t>(operand.variable)].derAttributes.unit; !unit.empty())
        return declared(unit);
    const MaybeUnit unit = infer(operand);
    if (!unit)
      return std::nullopt;
    const Unit rate = divide(unit->unit, *parseUnit("s"));
    return Inferred{rate, toString(rate)};
  }

  MaybeUnit binary(const Expr &expr) {
    const MaybeUnit left = of(expr.args[0]), right = of(expr.args[1]);
    switch (expr.op) {
    case Operator::Plus:
    case Operator::Minus:
      return unify(left, right, expr.span);
    case Operator::Times:
    case Operator::DotTimes:
    case Operator::Divide:
    case Operator::DotDivide: {
      if (!left || !right)
        return std::nullopt;
      const bool isProduct = expr.op == Operator::Times || expr.op == Operator::DotTimes;
      const Unit unit = isProduct ? multiply(left->unit, right->unit) : divide(left->unit, right->unit);
      return Inferred{unit, toString(unit)};
    }
    case Operator::Power:
    case Operator::DotPower: {
      const Expr &exponent = *expr.args[1];
      if (!left || exponent.kind != ExprKind::Literal || exponent.values.empty() ||
          std::ranges::any_of(exponent.values, [&](double v) { return v != exponent.values[0]; }))
        return std::nullopt;
      const Unit unit = power(left->unit, exponent.values[0]);
      return Inferred{unit, toString(unit)};
    }
    case Operator::And:
    case Operator::Or:
    case Operator::Not:
    case Operator::None:
      return std::nullopt;
    default:
      unify(left, right, expr.span);
      return std::nullopt;
    }
  }

  MaybeUnit call(const Expr &expr) {
    std::vector<MaybeUnit> units;
    units.reserve(expr.args.size());
    for (const ExprPtr &arg : expr.args)
      units.push_back(of(arg));
    switch (expr.function) {
    case Function::Abs:
    case Function::Sum:
    case Function::Transpose:
    case Function::Skew:
    case Function::Diagonal:
    case Function::Symmetric:
    case Function::Scalar:
    case Function::Vector:
    case Function::Matrix:
    case Function::NoEvent:
      return units[0];
    case Function::Smooth:
    case Function::Rotate:
      return units[1];
    case Function::Min:
    case Function::Max:
      return unify(units[0], units[1], expr.span);
    case Function::Sqrt: {
      if (!units[0])
        return std::nullopt;
      const Unit unit = power(units[0]->unit, 0.5);
      return Inferred{unit, toString(unit)};
    }
    default:
      return std::nullopt;
    }
  }

  const flat::FlatModel &model_;
  Diagnostics &diagnostics_;
  std::vector<MaybeUnit> units_;
  std::vector<bool> isKnown_;
  std::unordered_map<const Expr *, MaybeUnit> done_;
};

}  // namespace

void checkUnits(const flat::FlatModel &model, Diagnostics &diagnostics) { UnitInference(model, diagnostics).run(); }

}  // namespace tf::semantics
