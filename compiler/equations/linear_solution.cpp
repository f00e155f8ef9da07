#include "compiler/equations/equation_system.h"

#include <array>

namespace tf::equations {

using ir::NodeId;
using ir::Symbol;

LinearSolution solveLinear(ir::Graph &graph, NodeId left, NodeId right, Symbol unknown) {
  using enum LinearSolution::Outcome;
  const auto isUnknown = [&](Symbol symbol) { return symbol == unknown; };
  const NodeId node = graph.symbol(unknown.kind, unknown.index);
  if (left == node && !ir::dependsOn(graph, right, isUnknown))
    return {Solved, right};
  if (right == node && !ir::dependsOn(graph, left, isUnknown))
    return {Solved, left};
  const NodeId residual = graph.sub(left, right);
  const NodeId coefficient =
      ir::forwardDerivative(graph, std::array{residual}, [&](Symbol symbol) { return graph.constant(isUnknown(symbol) ? 1 : 0); })[0];
  if (graph.isConstant(coefficient, 0))
    return {Vanishing, -1};
  if (ir::dependsOn(graph, coefficient, isUnknown))
    return {Nonlinear, -1};
  const NodeId rest =
      ir::substitute(graph, std::array{residual}, [&](Symbol symbol) { return isUnknown(symbol) ? graph.constant(0) : -1; })[0];
  if (graph.isConstant(coefficient, -1))
    return {Solved, rest};
  return {Solved, graph.div(graph.neg(rest), coefficient)};
}

}  // namespace tf::equations
