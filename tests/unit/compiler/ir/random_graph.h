// Random expressions for property tests; smooth ones stay finite and differentiable wherever they are evaluated.
#pragma once

#include "compiler/ir/graph.h"

#include <random>

namespace tf::ir::testing {

struct RandomGraph {
  Graph graph;
  std::vector<NodeId> variables;
  std::vector<NodeId> nodes;
};

// `count` operations on `variableCount` states and constants. Arguments of singular functions are kept inside their domain.
inline RandomGraph randomSmoothGraph(unsigned seed, int variableCount, int count) {
  std::mt19937 random(seed);
  RandomGraph result;
  Graph &g = result.graph;
  for (int k = 0; k < variableCount; ++k)
    result.variables.push_back(g.symbol(SymbolKind::State, k));
  result.nodes = result.variables;
  result.nodes.push_back(g.constant(0.75));
  const auto any = [&] { return result.nodes[random() % result.nodes.size()]; };
  const auto bounded = [&](NodeId x) { return g.unary(Op::Tanh, x); };
  const auto positive = [&](NodeId x) { return g.add(g.constant(1.5), bounded(x)); };
  while (static_cast<int>(result.nodes.size()) < count) {
    NodeId node = -1;
    switch (random() % 16) {
    case 0:
      node = g.add(any(), any());
      break;
    case 1:
      node = g.sub(any(), any());
      break;
    case 2:
      node = g.mul(bounded(any()), bounded(any()));
      break;
    case 3:
      node = g.div(any(), positive(any()));
      break;
    case 4:
      node = g.unary(Op::Sin, any());
      break;
    case 5:
      node = g.unary(Op::Cos, any());
      break;
    case 6:
      node = g.unary(Op::Sqrt, positive(any()));
      break;
    case 7:
      node = g.unary(Op::Exp, bounded(any()));
      break;
    case 8:
      node = g.unary(Op::Log, positive(any()));
      break;
    case 9:
      node = g.neg(any());
      break;
    case 10:
      node = g.unary(Op::Atan, any());
      break;
    case 11:
      node = g.binary(Op::Atan2, any(), positive(any()));
      break;
    case 12:
      node = g.binary(Op::Pow, bounded(any()), g.constant(static_cast<double>(random() % 5)));
      break;
    case 13:
      node = g.ternary(Op::IfElse, g.binary(Op::Less, any(), any()), any(), any());
      break;
    case 14:
      node = g.binary(random() % 2 == 0 ? Op::Min : Op::Max, any(), any());
      break;
    default:
      node = g.select(g.unary(Op::Abs, bounded(any())), any(), any());
      break;
    }
    result.nodes.push_back(node);
  }
  return result;
}

}  // namespace tf::ir::testing
