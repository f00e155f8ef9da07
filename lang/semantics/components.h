// Components: their types, dimensions, instances, conditions and values, each found on demand.
#pragma once

#include "lang/semantics/context.h"
#include "lang/semantics/expressions.h"

namespace tf::semantics {

// Finds the type, dimensions and instances. False if there is an error: it was reported.
bool resolve(Context &context, Component &component);

// The inner component that an outer one stands for; others stand for themselves. Null: reported.
[[nodiscard]] Component *actual(Context &context, Component &component);

// Whether the component's condition holds.
[[nodiscard]] bool isPresent(Context &context, Component &component);

// Type of a variable with its dimensions; the component must be a resolved leaf.
[[nodiscard]] flat::Type typeOf(const Component &component);
[[nodiscard]] Variability variabilityOf(const Component &component);

// The flat variable or element of a resolved leaf, made at the first call.
[[nodiscard]] flat::VariableId variableOf(Context &context, Component &component);
[[nodiscard]] flat::ElementId elementOf(Context &context, Component &component);

// The typed value of the component's declaration, with its dimensions; null if there is none (or it is wrong: reported).
[[nodiscard]] ExprPtr bindingOf(Context &context, Component &component);

// The value of a constant or parameter, which becomes structural. Not reported if there is none.
[[nodiscard]] std::optional<std::vector<double>> valueOf(Context &context, Component &component);

// Types a binding, applies its projections; before broadcasting. Cached per expression and scope.
[[nodiscard]] ExprPtr typeBinding(Context &context, const Binding &binding);

// Types a binding of an attribute or value of something with dimensions `dims` (of it, `ownDims` are the component's own): broadcasts
// `each`, checks the shape. `name` for messages; `isDeclared`: it stands in the declaration itself, where there is no `each`.
[[nodiscard]] ExprPtr typeShapedBinding(Context &context, const Binding &binding, bool isEach, Base base, const std::vector<int> &dims,
                                        std::string_view name, bool isDeclared = false);

}  // namespace tf::semantics
