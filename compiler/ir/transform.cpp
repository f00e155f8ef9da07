#include "compiler/ir/graph.h"
#include "compiler/ir/operations.h"
#include "compiler/ir/subgraph.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <tuple>

namespace tf::ir {

namespace {

NodeId rebuild(Graph &graph, const Node &node, const NodeId operands[3]) {
  switch (node.arity) {
  case 1:
    return graph.unary(node.op, operands[0]);
  case 2:
    return graph.binary(node.op, operands[0], operands[1]);
  default:
    return graph.ternary(node.op, operands[0], operands[1], operands[2]);
  }
}

std::vector<Symbol> sortedSymbols(const Graph &graph, NodeId root) {
  std::vector<Symbol> symbols;
  const Subgraph reached(graph, std::array{root});
  for (const NodeId id : reached.nodes())
    if (graph[id].op == Op::Symbol)
      symbols.push_back(graph[id].symbol);
  std::sort(symbols.begin(), symbols.end(), [](Symbol a, Symbol b) { return std::tie(a.kind, a.index) < std::tie(b.kind, b.index); });
  return symbols;
}

}  // namespace

std::vector<NodeId> substitute(Graph &graph, std::span<const NodeId> roots, const std::function<NodeId(Symbol)> &replacement) {
  const Subgraph reached(graph, roots);
  std::vector<NodeId> images = reached.nodes();
  for (std::size_t k = 0; k < images.size(); ++k) {
    const Node node = graph[images[k]];
    if (node.op == Op::Symbol) {
      if (const NodeId image = replacement(node.symbol); image >= 0)
        images[k] = image;
      continue;
    }
    NodeId operands[3] = {-1, -1, -1};
    bool changed = false;
    for (int j = 0; j < node.arity; ++j) {
      operands[j] = images[static_cast<std::size_t>(reached.position(node.operands[j]))];
      changed = changed || operands[j] != node.operands[j];
    }
    if (changed)
      images[k] = rebuild(graph, node, operands);
  }
  std::vector<NodeId> result;
  result.reserve(roots.size());
  for (const NodeId root : roots)
    result.push_back(images[static_cast<std::size_t>(reached.position(root))]);
  return result;
}

std::vector<std::vector<Symbol>> dependencies(const Graph &graph, std::span<const NodeId> roots) {
  std::vector<std::vector<Symbol>> result;
  result.reserve(roots.size());
  for (const NodeId root : roots)
    result.push_back(sortedSymbols(graph, root));
  return result;
}

bool dependsOn(const Graph &graph, NodeId root, const std::function<bool(Symbol)> &predicate) {
  return dependsOn(graph, std::array{root}, predicate);
}

bool dependsOn(const Graph &graph, std::span<const NodeId> roots, const std::function<bool(Symbol)> &predicate) {
  const Subgraph reached(graph, roots);
  return std::any_of(reached.nodes().begin(), reached.nodes().end(),
                     [&](NodeId id) { return graph[id].op == Op::Symbol && predicate(graph[id].symbol); });
}

double applyNode(const Graph &graph, const Node &node, std::span<const double> operands) {
  const auto exponent = node.op == Op::Pow ? multipliedExponent(graph, node.operands[1]) : std::nullopt;
  return exponent ? integerPower(operands[0], *exponent) : applyOperation(node.op, operands);
}

std::vector<double> evaluate(const Graph &graph, std::span<const NodeId> roots, const std::function<double(Symbol)> &value) {
  const Subgraph reached(graph, roots);
  std::vector<double> values(static_cast<std::size_t>(reached.size()));
  const auto valueOf = [&](NodeId id) { return values[static_cast<std::size_t>(reached.position(id))]; };
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Node &node = graph[reached.node(static_cast<int>(k))];
    if (node.op == Op::Constant) {
      values[k] = node.value;
    } else if (node.op == Op::Symbol) {
      values[k] = value(node.symbol);
    } else {
      double operands[3] = {};
      for (int j = 0; j < node.arity; ++j)
        operands[j] = valueOf(node.operands[j]);
      values[k] = applyNode(graph, node, std::span(operands, node.arity));
    }
  }
  std::vector<double> result;
  result.reserve(roots.size());
  for (const NodeId root : roots)
    result.push_back(valueOf(root));
  return result;
}

}  // namespace tf::ir
