#include "compiler/ir/function.h"
#include "compiler/ir/operations.h"
#include "compiler/ir/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

namespace tf::ir {

std::string verify(const Graph &graph) {
  using Key = std::tuple<Op, SymbolKind, std::int32_t, std::uint64_t, NodeId, NodeId, NodeId>;
  std::set<Key> seen;
  for (NodeId id = 0; id < graph.size(); ++id) {
    const Node &node = graph[id];
    if (node.arity != arity(node.op))
      return fmt::format("node {}: arity {} instead of {}", id, node.arity, arity(node.op));
    for (int k = 0; k < 3; ++k) {
      const NodeId operand = node.operands[k];
      if (k < node.arity ? operand < 0 || operand >= id : operand != -1)
        return fmt::format("node {}: operand {} is node {}", id, k, operand);
    }
    const Key key{node.op,          node.symbol.kind, node.symbol.index, std::bit_cast<std::uint64_t>(node.value),
                  node.operands[0], node.operands[1], node.operands[2]};
    if (!seen.insert(key).second)
      return fmt::format("node {}: is there twice", id);
  }
  return {};
}

namespace {

// What is wrong with a place out[buffer][position] and a group; empty if nothing.
std::string wrongPlace(const Function &function, int buffer, int position, int group) {
  const auto where = [&] { return fmt::format("{}: out[{}][{}]", function.name, buffer, position); };
  if (buffer < 0 || buffer >= static_cast<int>(function.bufferSizes.size()))
    return where() + ": there is no such buffer";
  if (position < 0 || position >= function.bufferSizes[static_cast<std::size_t>(buffer)])
    return where() + ": beyond the buffer's end";
  if (group < -1 || group >= function.groups)
    return fmt::format("{}: there is no group {}", where(), group);
  return {};
}

std::string verifyRun(const Function &function, const Sweep::Run &run, std::set<std::pair<int, int>> &stored) {
  if (run.count < 1 || run.first < 0 || run.first + run.count > static_cast<int>(function.sweep->results.size()))
    return fmt::format("{}: there are no results {} to {}", function.name, run.first, run.first + run.count - 1);
  for (int k = 0; k < run.count; ++k) {
    const int position = run.position + k * run.stride;
    if (std::string wrong = wrongPlace(function, run.buffer, position, run.group); !wrong.empty())
      return wrong;
    if (!stored.emplace(run.buffer, position).second)
      return fmt::format("{}: out[{}][{}]: stored twice", function.name, run.buffer, position);
  }
  return {};
}

std::string verifyProducts(const Function &function, const Graph &graph) {
  const Sweep &sweep = *function.sweep;
  const auto buffer = static_cast<std::size_t>(sweep.products);
  const int size = static_cast<int>(sweep.results.size()) * Sweep::directions;
  if (buffer >= function.bufferSizes.size() || function.bufferSizes[buffer] != size)
    return fmt::format("{}: out[{}]: there is no such buffer of {} products", function.name, sweep.products, size);
  if (function.groups > 0)
    return fmt::format("{}: the mask selects groups and products", function.name);
  // What depends on no seed is not evaluated in the loop.
  std::vector<NodeId> nodes(sweep.results.size());
  std::ranges::transform(sweep.results, nodes.begin(), &Sweep::Result::node);
  const std::vector<std::vector<int>> structure = seedStructure(graph, nodes, sweep.seedCount);
  for (std::size_t k = 0; k < structure.size(); ++k)
    if (structure[k].empty())
      return fmt::format("{}: products with a result {} that depends on no seed", function.name, k);
  return {};
}

std::string verifySweep(const Function &function, const Graph &graph, std::set<std::pair<int, int>> &stored) {
  const Sweep &sweep = *function.sweep;
  for (const Sweep::Result &result : sweep.results) {
    if (result.node < 0 || result.node >= graph.size())
      return fmt::format("{}: there is no node {}", function.name, result.node);
    if (result.group < -1 || result.group >= function.groups)
      return fmt::format("{}: there is no group {}", function.name, result.group);
  }
  if (sweep.products >= 0)
    if (std::string wrong = verifyProducts(function, graph); !wrong.empty())
      return wrong;
  for (const Sweep::Colour &colour : sweep.colours) {
    for (const int seed : colour.seeds)
      if (seed < 0 || seed >= sweep.seedCount)
        return fmt::format("{}: there is no seed {}", function.name, seed);
    for (const Sweep::Run &run : colour.runs)
      if (std::string wrong = verifyRun(function, run, stored); !wrong.empty())
        return wrong;
  }
  return {};
}

}  // namespace

std::string verify(const Function &function, const Graph &graph) {
  std::set<std::pair<int, int>> stored;
  std::vector<NodeId> nodes;
  for (const std::vector<Store> *stores : {&function.stores, &function.additions})
    for (const Store &store : *stores) {
      if (std::string wrong = wrongPlace(function, store.buffer, store.position, store.group); !wrong.empty())
        return wrong;
      if (store.node < 0 || store.node >= graph.size())
        return fmt::format("{}: out[{}][{}]: there is no node {}", function.name, store.buffer, store.position, store.node);
      if (stores == &function.stores && !stored.emplace(store.buffer, store.position).second)
        return fmt::format("{}: out[{}][{}]: stored twice", function.name, store.buffer, store.position);
      nodes.push_back(store.node);
    }
  if (dependsOn(graph, nodes, [](Symbol symbol) { return symbol.kind == SymbolKind::Seed; }))
    return fmt::format("{}: a store depends on a seed", function.name);
  for (const Clear &clear : function.clears)
    for (const int position : {clear.position, clear.position + clear.length - 1})
      if (std::string wrong = wrongPlace(function, clear.buffer, position, clear.group); !wrong.empty())
        return wrong;
  return function.sweep ? verifySweep(function, graph, stored) : std::string{};
}

}  // namespace tf::ir
