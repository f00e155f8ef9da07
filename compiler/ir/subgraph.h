// What a set of roots reaches, in topological order, with dense positions: the frame of every pass over the graph. Costs are linear in what
// is reached, whatever the size of the graph, and nothing recurses.
#pragma once

#include "compiler/ir/graph.h"

namespace tf::ir {

class Subgraph {
public:
  Subgraph(const Graph &graph, std::span<const NodeId> roots);

  [[nodiscard]] int size() const { return static_cast<int>(nodes_.size()); }
  // Ascending ids, hence operands first.
  [[nodiscard]] const std::vector<NodeId> &nodes() const { return nodes_; }
  [[nodiscard]] NodeId node(int position) const { return nodes_[static_cast<std::size_t>(position)]; }
  // Position of a node in nodes(), −1 if it is not reached.
  [[nodiscard]] int position(NodeId id) const;

private:
  struct Slot {
    NodeId id = -1;
    std::int32_t position = -1;
  };

  bool insert(NodeId id);
  [[nodiscard]] std::size_t slotOf(NodeId id) const;
  void grow();

  std::vector<NodeId> nodes_;
  std::vector<Slot> table_;
};

}  // namespace tf::ir
