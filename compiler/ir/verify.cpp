#include "compiler/ir/function.h"
#include "compiler/ir/operations.h"

#include <fmt/format.h>

#include <bit>
#include <set>
#include <tuple>

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

std::string verify(const Function &function, const Graph &graph) {
  std::set<std::pair<int, int>> stored;
  for (const Store &store : function.stores) {
    const auto where = [&] { return fmt::format("{}: out[{}][{}]", function.name, store.buffer, store.position); };
    if (store.buffer < 0 || store.buffer >= static_cast<int>(function.bufferSizes.size()))
      return where() + ": there is no such buffer";
    if (store.position < 0 || store.position >= function.bufferSizes[static_cast<std::size_t>(store.buffer)])
      return where() + ": beyond the buffer's end";
    if (store.node < 0 || store.node >= graph.size())
      return fmt::format("{}: there is no node {}", where(), store.node);
    if (store.group < -1 || store.group >= function.groups)
      return fmt::format("{}: there is no group {}", where(), store.group);
    if (!stored.emplace(store.buffer, store.position).second)
      return where() + ": stored twice";
  }
  return {};
}

}  // namespace tf::ir
