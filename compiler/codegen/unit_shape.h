// What units have in common whose code differs in numbers only: which constants, symbols, slots and places of results they use.
#pragma once

#include "compiler/codegen/code_unit.h"
#include "compiler/ir/subgraph.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace tf::codegen {

// A number in which units of one shape may differ.
struct Place {
  enum class Kind : std::uint8_t {
    Constant,  // value of the node
    Symbol,    // index of the node's symbol
    Slot,      // of the node
    Position,  // of the step
    Length,    // of the step
  };
  Kind kind = Kind::Constant;
  ir::NodeId node = -1;
  int step = -1;
};

// `code` is the same for two units if and only if one becomes the other by other numbers at its places, which are listed in one order.
struct UnitShape {
  std::vector<std::int64_t> code;
  std::vector<Place> places;
};

// Numbers of the nodes of a subgraph, by their positions, that are the same for nodes which become one another by other constants and other
// symbols of the same kinds.
[[nodiscard]] std::vector<std::uint64_t> likenesses(const ir::Graph &graph, const ir::Subgraph &nodes);

// What a unit's shape depends on beside the unit and the graph.
struct ShapeContext {
  std::function<bool(ir::NodeId)> leaves;   // a node of the unit that others use
  std::function<bool(ir::NodeId)> isSwept;  // a node that depends on seeds
  std::function<std::uint64_t(ir::NodeId)> likeness;
};

// A node's operands in an order that is the same for nodes that are alike: of sums and products the one that is by chance of the smaller id
// need not be first.
[[nodiscard]] std::array<ir::NodeId, 3> alignedOperands(const ir::Node &node, const std::function<std::uint64_t(ir::NodeId)> &likeness);

[[nodiscard]] UnitShape shapeOf(const Unit &unit, const ir::Graph &graph, const ShapeContext &context);

}  // namespace tf::codegen
