// Rules that need the whole model.
#include "lang/semantics/components.h"
#include "lang/semantics/diagnostics.h"
#include "lang/semantics/flatten.h"

#include <algorithm>
#include <set>

namespace tf::semantics {

namespace {

using flat::Expr;
using flat::ExprKind;

void collectVariables(const Expr &expr, std::set<flat::VariableId> &variables) {
  if (expr.kind == ExprKind::Variable)
    variables.insert(expr.variable);
  for (const ExprPtr &arg : expr.args)
    collectVariables(*arg, variables);
}

// Parameters must not define one another in a circle.
class ParameterOrder {
public:
  explicit ParameterOrder(Context &context) : context_(context), progress_(context.model.variables.size(), Progress::Fresh) {}

  void run() {
    for (std::size_t i = 0; i < progress_.size(); ++i)
      visit(static_cast<flat::VariableId>(i), 0);
  }

private:
  bool visit(flat::VariableId id, int depth) {
    const auto at = static_cast<std::size_t>(id);
    const flat::Variable &variable = context_.model.variables[at];
    if (variable.variability > Variability::Parameter || progress_[at] == Progress::Done || variable.binding == nullptr)
      return true;
    if (progress_[at] == Progress::Running || depth > kMaximumExpressionDepth) {
      context_.diagnostics.report(diag::CyclicDefinition, variable.span, variable.name);
      return false;
    }
    progress_[at] = Progress::Running;
    std::set<flat::VariableId> used;
    collectVariables(*variable.binding, used);
    bool isRight = true;
    for (const flat::VariableId other : used)
      isRight = isRight && visit(other, depth + 1);
    progress_[at] = Progress::Done;
    return isRight;
  }

  Context &context_;
  std::vector<Progress> progress_;
};

// `v = der(x)` makes v an alias of the velocity; then `der(v) = …`, like `der(der(x)) = …`, would fix an acceleration that the equations
// of motion determine.
class AccelerationRule {
public:
  explicit AccelerationRule(Context &context) : context_(context), model_(context.model) {}

  void run() {
    for (const flat::Variable &variable : model_.variables)
      if (variable.binding != nullptr && isVelocity(*variable.binding))
        velocities_.insert(static_cast<flat::VariableId>(&variable - model_.variables.data()));
    for (const flat::Equation &equation : model_.equations) {
      if (equation.left->kind == ExprKind::Variable && isVelocity(*equation.right))
        velocities_.insert(equation.left->variable);
      if (equation.right->kind == ExprKind::Variable && isVelocity(*equation.left))
        velocities_.insert(equation.right->variable);
    }
    for (const flat::Equation &equation : model_.equations) {
      if (equation.isInitial)
        continue;
      check(*equation.left, *equation.right);
      check(*equation.right, *equation.left);
    }
  }

private:
  [[nodiscard]] bool isCoordinate(const Expr &expr) const {
    return expr.kind == ExprKind::Variable && model_.variables[static_cast<std::size_t>(expr.variable)].isCoordinate;
  }
  [[nodiscard]] bool isVelocity(const Expr &expr) const {
    return (expr.kind == ExprKind::Derivative && isCoordinate(*expr.args[0])) ||
           (expr.kind == ExprKind::Variable && model_.variables[static_cast<std::size_t>(expr.variable)].isAngularVelocity);
  }
  [[nodiscard]] bool isAcceleration(const Expr &expr) const {
    if (expr.kind != ExprKind::Derivative)
      return false;
    const Expr &inner = *expr.args[0];
    return isVelocity(inner) || (inner.kind == ExprKind::Variable && velocities_.contains(inner.variable));
  }

  // A variable that the acceleration defines is only a name for it.
  [[nodiscard]] bool isName(const Expr &expr) const {
    if (expr.kind != ExprKind::Variable)
      return false;
    const flat::Variable &variable = model_.variables[static_cast<std::size_t>(expr.variable)];
    return !variable.isCoordinate && variable.binding == nullptr && variable.variability == Variability::Continuous &&
           variable.causality != flat::Causality::Input && !velocities_.contains(expr.variable);
  }

  void check(const Expr &side, const Expr &other) {
    if (isAcceleration(side) && !isName(other))
      context_.diagnostics.report(diag::AccelerationFixed, side.span, context_.sources.text(side.span));
  }

  Context &context_;
  const flat::FlatModel &model_;
  std::set<flat::VariableId> velocities_;
};

}  // namespace

void checkModel(Context &context) {
  if (context.diagnostics.hasErrors())
    return;
  ParameterOrder(context).run();
  AccelerationRule(context).run();
}

}  // namespace tf::semantics
