// How far values can move: bounds in ball arithmetic (J. van der Hoeven, Ball arithmetic, 2009), built as expressions.
#pragma once

#include "compiler/ir/graph.h"

namespace tf::ir {

// For each root f an expression r ≥ |f(x) − f(x₀)| for all x with |x_k − x₀_k| ≤ radius(k) of every symbol k, evaluated at x₀ (to
// rounding). `radius` gives the constant 0 for what does not move. Where no bound is known, r is infinite or not a number. One memoised
// sweep: its size is a constant times that of what the roots reach.
[[nodiscard]] std::vector<NodeId> deviationBounds(Graph &graph, std::span<const NodeId> roots, const std::function<NodeId(Symbol)> &radius);

}  // namespace tf::ir
