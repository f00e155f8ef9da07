// The last pass: structural parameters are replaced by their values, variables stand in the order of their declarations.
#include "lang/semantics/components.h"
#include "lang/semantics/flatten.h"

#include <algorithm>
#include <unordered_map>

namespace tf::semantics {

namespace {

using flat::Expr;
using flat::ExprKind;

class Finishing {
public:
  Finishing(Context &context, const std::vector<flat::VariableId> &declared) : context_(context), model_(context.model) {
    order_ = declared;
    newIds_.assign(model_.variables.size(), -1);
    for (std::size_t i = 0; i < order_.size(); ++i)
      newIds_[static_cast<std::size_t>(order_[i])] = static_cast<flat::VariableId>(i);
  }

  void run() {
    foldBindings();
    for (flat::Variable &variable : model_.variables) {
      rewriteAll(variable.attributes);
      rewriteAll(variable.derAttributes);
      rewrite(variable.binding);
    }
    for (flat::Element &element : model_.elements)
      for (flat::Attribute &attribute : element.attributes)
        rewrite(attribute.value);
    for (flat::Equation &equation : model_.equations) {
      rewrite(equation.left);
      rewrite(equation.right);
    }
    for (flat::Assertion &assertion : model_.assertions)
      rewrite(assertion.condition);
    reorder();
  }

private:
  [[nodiscard]] const std::optional<std::vector<double>> &structuralValue(flat::VariableId id) const {
    static const std::optional<std::vector<double>> kNone;
    const auto at = static_cast<std::size_t>(id);
    return model_.variables[at].isStructural ? context_.variableOwners[at]->value : kNone;
  }

  void foldBindings() {
    for (std::size_t i = 0; i < model_.variables.size(); ++i) {
      flat::Variable &variable = model_.variables[i];
      if (const auto &value = structuralValue(static_cast<flat::VariableId>(i)))
        variable.binding = makeLiteral(variable.type, *value, variable.binding == nullptr ? variable.span : variable.binding->span);
    }
  }

  void rewriteAll(flat::Attributes &attributes) {
    for (ExprPtr *expr : {&attributes.start, &attributes.fixed, &attributes.min, &attributes.max, &attributes.nominal})
      rewrite(*expr);
  }

  void rewrite(ExprPtr &expr) {
    if (expr != nullptr)
      expr = rewritten(expr);
  }

  ExprPtr rewritten(const ExprPtr &expr) {
    const auto known = done_.find(expr.get());
    if (known != done_.end())
      return known->second;
    ExprPtr result = expr->kind == ExprKind::Variable ? variable(expr) : node(expr);
    keep_.push_back(expr);
    done_.emplace(expr.get(), result);
    return result;
  }

  ExprPtr variable(const ExprPtr &expr) {
    if (const auto &value = structuralValue(expr->variable)) {
      const std::vector<int> &dims = context_.variableOwners[static_cast<std::size_t>(expr->variable)]->dimensions;
      return makeLiteral(expr->type, expr->indices.empty() ? *value : selectValues(*value, dims, expr->indices), expr->span);
    }
    const flat::VariableId id = newIds_[static_cast<std::size_t>(expr->variable)];
    if (id == expr->variable)
      return expr;
    auto copy = std::make_shared<Expr>(*expr);
    copy->variable = id;
    return copy;
  }

  ExprPtr node(const ExprPtr &expr) {
    std::vector<ExprPtr> args;
    bool isChanged = false;
    for (const ExprPtr &arg : expr->args) {
      args.push_back(rewritten(arg));
      isChanged = isChanged || args.back() != arg;
    }
    if (!isChanged)
      return expr;
    auto copy = std::make_shared<Expr>(*expr);
    copy->args = std::move(args);
    return copy;
  }

  void reorder() {
    std::vector<flat::Variable> variables;
    std::vector<Component *> owners;
    for (const flat::VariableId id : order_) {
      variables.push_back(std::move(model_.variables[static_cast<std::size_t>(id)]));
      owners.push_back(context_.variableOwners[static_cast<std::size_t>(id)]);
    }
    model_.variables = std::move(variables);
    context_.variableOwners = std::move(owners);
  }

  Context &context_;
  flat::FlatModel &model_;
  std::vector<flat::VariableId> order_;
  std::vector<flat::VariableId> newIds_;
  std::unordered_map<const Expr *, ExprPtr> done_;
  std::vector<ExprPtr> keep_;  // keys of done_ stay alive
};

}  // namespace

void finishModel(Context &context, const std::vector<flat::VariableId> &declared) {
  if (!context.diagnostics.hasErrors())
    Finishing(context, declared).run();
}

}  // namespace tf::semantics
