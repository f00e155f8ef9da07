#include "compiler/ir/subgraph.h"

#include <algorithm>

namespace tf::ir {

Subgraph::Subgraph(const Graph &graph, std::span<const NodeId> roots) : table_(64) {
  std::vector<NodeId> pending;
  const auto visit = [&](NodeId id) {
    if (insert(id))
      pending.push_back(id);
  };
  for (const NodeId root : roots)
    visit(root);
  while (!pending.empty()) {
    const Node &node = graph[pending.back()];
    pending.pop_back();
    for (int k = 0; k < node.arity; ++k)
      visit(node.operands[k]);
  }
  std::sort(nodes_.begin(), nodes_.end());
  for (int k = 0; k < size(); ++k)
    table_[slotOf(node(k))].position = k;
}

int Subgraph::position(NodeId id) const {
  const Slot &slot = table_[slotOf(id)];
  return slot.id == id ? slot.position : -1;
}

// The slot that holds the id, or the free one where it belongs. Ids of a subgraph are clustered; a multiplication spreads them.
std::size_t Subgraph::slotOf(NodeId id) const {
  const std::size_t last = table_.size() - 1;
  std::size_t slot = (static_cast<std::uint64_t>(id) * 0x9e3779b97f4a7c15ULL >> 32U) & last;
  while (table_[slot].id >= 0 && table_[slot].id != id)
    slot = (slot + 1) & last;
  return slot;
}

bool Subgraph::insert(NodeId id) {
  Slot &slot = table_[slotOf(id)];
  if (slot.id == id)
    return false;
  slot.id = id;
  nodes_.push_back(id);
  if (2 * nodes_.size() > table_.size())
    grow();
  return true;
}

void Subgraph::grow() {
  table_.assign(2 * table_.size(), Slot{});
  for (const NodeId id : nodes_)
    table_[slotOf(id)].id = id;
}

}  // namespace tf::ir
