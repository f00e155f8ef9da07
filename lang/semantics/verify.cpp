// The contract of flat_model.h, checked.
#include "lang/semantics/expressions.h"
#include "lang/semantics/flat_model.h"

#include <fmt/format.h>

#include <set>
#include <unordered_set>

namespace tf::flat {

namespace {

class Verifier {
public:
  explicit Verifier(const FlatModel &model) : model_(model) {}

  std::string run() {
    std::set<std::string> names;
    for (const Variable &variable : model_.variables) {
      require(names.insert(variable.name).second, "two things are named " + variable.name);
      checkVariable(variable);
    }
    for (const Element &element : model_.elements) {
      require(names.insert(element.name).second, "two things are named " + element.name);
      for (const Attribute &attribute : element.attributes)
        checkAttribute(element, attribute);
    }
    for (const Equation &equation : model_.equations) {
      check(equation.left, "an equation");
      check(equation.right, "an equation");
      if (equation.left != nullptr && equation.right != nullptr)
        require(equation.left->type == equation.right->type, "the sides of an equation differ in type");
    }
    for (const Assertion &assertion : model_.assertions)
      check(assertion.condition, "an assertion");
    return violation_;
  }

private:
  void require(bool holds, const std::string &what) {
    if (!holds && violation_.empty())
      violation_ = what;
  }

  void checkVariable(const Variable &variable) {
    for (const Attributes *attributes : {&variable.attributes, &variable.derAttributes})
      for (const ExprPtr &value : {attributes->start, attributes->fixed, attributes->min, attributes->max, attributes->nominal})
        if (value != nullptr) {
          check(value, variable.name);
          require(value->type.dims == variable.type.dims, "an attribute of " + variable.name + " has other dimensions");
        }
    if (variable.binding == nullptr)
      return;
    check(variable.binding, variable.name);
    require(variable.binding->type == variable.type, "the binding of " + variable.name + " has another type");
  }

  void checkAttribute(const Element &element, const Attribute &attribute) {
    check(attribute.value, element.name);
    if (attribute.value == nullptr)
      return;
    const std::vector<int> &dims = attribute.value->type.dims;
    require(dims.size() >= element.dims.size() && std::equal(element.dims.begin(), element.dims.end(), dims.begin()),
            "attribute " + attribute.name + " of " + element.name + " lacks the element's dimensions");
  }

  void check(const ExprPtr &expr, const std::string &where) {
    if (expr == nullptr) {
      require(false, "a null expression in " + where);
      return;
    }
    if (!violation_.empty() || !visited_.insert(expr.get()).second)
      return;
    checkNode(*expr, where);
    for (const ExprPtr &arg : expr->args)
      check(arg, where);
  }

  void checkNode(const Expr &expr, const std::string &where) {
    switch (expr.kind) {
    case ExprKind::Literal:
      require(static_cast<int>(expr.values.size()) == expr.type.size(), "a literal of wrong size in " + where);
      break;
    case ExprKind::Variable:
      checkReference(expr, where);
      break;
    case ExprKind::Attribute:
      require(expr.element >= 0 && static_cast<std::size_t>(expr.element) < model_.elements.size(), "an unknown element in " + where);
      break;
    case ExprKind::Binary:
      require(expr.args.size() == 2, "a binary operator without two operands in " + where);
      break;
    case ExprKind::If:
      require(expr.args.size() == 3 && expr.args[1]->type == expr.args[2]->type, "an if-expression of mixed types in " + where);
      break;
    case ExprKind::Array:
      require(!expr.args.empty() && !expr.type.dims.empty() && static_cast<int>(expr.args.size()) == expr.type.dims[0],
              "an array of wrong size in " + where);
      break;
    case ExprKind::Derivative:
      require(expr.args.size() == 1 && expr.args[0]->type == expr.type, "a derivative of another type in " + where);
      break;
    default:
      break;
    }
  }

  void checkReference(const Expr &expr, const std::string &where) {
    const bool isKnown = expr.variable >= 0 && static_cast<std::size_t>(expr.variable) < model_.variables.size();
    require(isKnown, "an unknown variable in " + where);
    if (!isKnown)
      return;
    const Variable &variable = model_.variables[static_cast<std::size_t>(expr.variable)];
    require(!variable.isStructural, "the structural parameter " + variable.name + " is not folded in " + where);
    require(expr.indices.empty() ? expr.type.dims == variable.type.dims : expr.indices.size() == variable.type.dims.size(),
            "a reference to " + variable.name + " of wrong dimensions in " + where);
    for (std::size_t i = 0; i < expr.indices.size() && i < variable.type.dims.size(); ++i)
      for (const int position : expr.indices[i].positions)
        require(position >= 1 && position <= variable.type.dims[i], "a reference outside of " + variable.name + " in " + where);
  }

  const FlatModel &model_;
  std::string violation_;
  std::unordered_set<const Expr *> visited_;
};

}  // namespace

std::string verify(const FlatModel &model) { return Verifier(model).run(); }

}  // namespace tf::flat
