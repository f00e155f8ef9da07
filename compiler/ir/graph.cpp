#include "compiler/ir/graph.h"

#include "compiler/ir/operations.h"

#include <bit>
#include <cassert>

namespace tf::ir {

namespace {

std::uint64_t mix(std::uint64_t hash, std::uint64_t value) {
  // The finaliser of SplitMix64.
  hash ^= value + 0x9e3779b97f4a7c15ULL + (hash << 6U) + (hash >> 2U);
  hash = (hash ^ (hash >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  hash = (hash ^ (hash >> 27U)) * 0x94d049bb133111ebULL;
  return hash ^ (hash >> 31U);
}

std::uint64_t hashOf(const Node &node) {
  switch (node.op) {
  case Op::Constant:
    return mix(0, std::bit_cast<std::uint64_t>(node.value));
  case Op::Symbol:
    return mix(static_cast<std::uint64_t>(node.symbol.kind) + 1U, static_cast<std::uint32_t>(node.symbol.index));
  default: {
    const auto first = static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.operands[0])) << 32U;
    const auto second = static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.operands[1]));
    const auto third = static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.operands[2])) << 8U;
    return mix(first | second, third | static_cast<std::uint64_t>(node.op));
  }
  }
}

bool equal(const Node &a, const Node &b) {
  return a.op == b.op && a.symbol == b.symbol && std::bit_cast<std::uint64_t>(a.value) == std::bit_cast<std::uint64_t>(b.value) &&
         a.operands[0] == b.operands[0] && a.operands[1] == b.operands[1] && a.operands[2] == b.operands[2];
}

}  // namespace

Graph::Graph() { rehash(256); }

void Graph::rehash(std::size_t slots) {
  table_.assign(slots, -1);
  for (NodeId id = 0; id < size(); ++id) {
    std::size_t slot = hashOf(nodes_[static_cast<std::size_t>(id)]) & (slots - 1);
    while (table_[slot] >= 0)
      slot = (slot + 1) & (slots - 1);
    table_[slot] = id;
  }
}

NodeId Graph::insert(const Node &node) {
  const std::size_t last = table_.size() - 1;
  std::size_t slot = hashOf(node) & last;
  for (; table_[slot] >= 0; slot = (slot + 1) & last)
    if (equal(nodes_[static_cast<std::size_t>(table_[slot])], node))
      return table_[slot];
  const NodeId id = size();
  table_[slot] = id;
  nodes_.push_back(node);
  if (2 * nodes_.size() > table_.size())
    rehash(2 * table_.size());
  return id;
}

NodeId Graph::constant(double value) {
  Node node;
  node.value = value;
  return insert(node);
}

NodeId Graph::symbol(SymbolKind kind, int index) {
  Node node;
  node.op = Op::Symbol;
  node.symbol = {kind, index};
  return insert(node);
}

bool Graph::isConstant(NodeId id, double value) const {
  const Node &node = (*this)[id];
  return node.op == Op::Constant && node.value == value;
}

NodeId Graph::operation(Op op, std::span<const NodeId> operands) {
  assert(static_cast<int>(operands.size()) == arity(op));
  Node node;
  node.op = op;
  node.arity = static_cast<std::uint8_t>(operands.size());
  for (std::size_t k = 0; k < operands.size(); ++k) {
    assert(operands[k] >= 0 && operands[k] < size());
    node.operands[k] = operands[k];
  }
  return insert(node);
}

NodeId Graph::sum(std::span<const NodeId> terms) {
  std::vector<NodeId> level;
  for (const NodeId term : terms)
    if (!isConstant(term, 0))
      level.push_back(term);
  if (level.empty())
    return constant(0);
  while (level.size() > 1) {
    std::size_t count = 0;
    for (std::size_t k = 0; k + 1 < level.size(); k += 2)
      level[count++] = add(level[k], level[k + 1]);
    if (level.size() % 2 != 0)
      level[count++] = level.back();
    level.resize(count);
  }
  return level.front();
}

}  // namespace tf::ir
