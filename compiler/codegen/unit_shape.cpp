#include "compiler/codegen/unit_shape.h"

#include "compiler/ir/operations.h"

#include <unordered_map>
#include <utility>

namespace tf::codegen {

namespace {

// What an operand is, and what a step begins with.
enum Mark : std::int64_t { Local = 1, Bound, Exponent, Leaves, Stays, FirstStep };

class Reader {
public:
  Reader(const Unit &unit, const ir::Graph &graph, const ShapeContext &context) : unit_(unit), graph_(graph), context_(context) {}

  UnitShape run() {
    for (std::size_t k = 0; k < unit_.steps.size(); ++k)
      read(unit_.steps[k], static_cast<int>(k));
    return std::move(shape_);
  }

private:
  void read(const Step &step, int number) {
    add({FirstStep + static_cast<std::int64_t>(step.kind), step.buffer});
    switch (step.kind) {
    case Step::Kind::Evaluate:
      return readNode(step.node);
    case Step::Kind::Store:
    case Step::Kind::Add:
    case Step::Kind::Result:
      readOperand(step.node);
      return place({Place::Kind::Position, -1, number});
    case Step::Kind::Clear:
      place({Place::Kind::Position, -1, number});
      return place({Place::Kind::Length, -1, number});
    }
  }

  void readNode(ir::NodeId id) {
    const ir::Node &node = graph_[id];
    add({static_cast<std::int64_t>(node.op), node.arity});
    const std::array<ir::NodeId, 3> operands = alignedOperands(node, context_.likeness);
    for (std::size_t k = 0; k < node.arity; ++k)
      // Constant exponents are multiplied out.
      if (const auto exponent = node.op == ir::Op::Pow && k == 1 ? ir::multipliedExponent(graph_, operands[1]) : std::nullopt)
        add({Exponent, *exponent});
      else
        readOperand(operands[k]);
    locals_.emplace(id, static_cast<std::int64_t>(locals_.size()));
    if (context_.leaves(id)) {
      add({Leaves});
      place({Place::Kind::Slot, id, -1});
    } else {
      add({Stays});
    }
  }

  void readOperand(ir::NodeId id) {
    if (const auto local = locals_.find(id); local != locals_.end())
      return add({Local, local->second});
    const ir::Node &node = graph_[id];
    const bool isLeaf = node.arity == 0, isConstant = node.op == ir::Op::Constant;
    const auto [bound, isNew] = bound_.emplace(id, static_cast<std::int64_t>(bound_.size()));
    add({Bound, bound->second});
    if (!isNew)
      return;
    add({isConstant ? -1 : isLeaf ? static_cast<std::int64_t>(node.symbol.kind) : context_.isSwept(id) ? -2 : -3});
    place({isConstant ? Place::Kind::Constant : isLeaf ? Place::Kind::Symbol : Place::Kind::Slot, id, -1});
  }

  void add(std::initializer_list<std::int64_t> words) { shape_.code.insert(shape_.code.end(), words); }
  void place(const Place &place) { shape_.places.push_back(place); }

  const Unit &unit_;
  const ir::Graph &graph_;
  const ShapeContext &context_;
  std::unordered_map<ir::NodeId, std::int64_t> locals_, bound_;
  UnitShape shape_;
};

// Of one word after another (the finaliser of splitmix64).
std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) {
  std::uint64_t z = hash * 0x9e3779b97f4a7c15 + word;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111eb;
  return z ^ (z >> 31U);
}

bool isAligned(ir::Op op) { return op == ir::Op::Add || op == ir::Op::Mul; }

}  // namespace

std::array<ir::NodeId, 3> alignedOperands(const ir::Node &node, const std::function<std::uint64_t(ir::NodeId)> &likeness) {
  std::array<ir::NodeId, 3> operands = {node.operands[0], node.operands[1], node.operands[2]};
  if (isAligned(node.op) && likeness(operands[1]) < likeness(operands[0]))
    std::swap(operands[0], operands[1]);
  return operands;
}

std::vector<std::uint64_t> likenesses(const ir::Graph &graph, const ir::Subgraph &nodes) {
  std::vector<std::uint64_t> likeness(static_cast<std::size_t>(nodes.size()));
  for (std::size_t k = 0; k < likeness.size(); ++k) {
    const ir::Node &node = graph[nodes.node(static_cast<int>(k))];
    std::uint64_t hash = mixed(static_cast<std::uint64_t>(node.op), static_cast<std::uint64_t>(node.symbol.kind));
    std::array<std::uint64_t, 3> operands{};
    for (std::size_t j = 0; j < node.arity; ++j)
      operands[j] = likeness[static_cast<std::size_t>(nodes.position(node.operands[j]))];
    if (isAligned(node.op) && operands[1] < operands[0])
      std::swap(operands[0], operands[1]);
    for (std::size_t j = 0; j < node.arity; ++j)
      hash = mixed(hash, operands[j]);
    likeness[k] = hash;
  }
  return likeness;
}

UnitShape shapeOf(const Unit &unit, const ir::Graph &graph, const ShapeContext &context) { return Reader(unit, graph, context).run(); }

}  // namespace tf::codegen
