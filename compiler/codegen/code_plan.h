// How a function is laid out: what is evaluated under which guard, in which order, in pieces of bounded size. Knows nothing of LLVM.
#pragma once

#include "compiler/ir/function.h"

#include <cstdint>
#include <vector>

namespace tf::codegen {

// A step of straight-line code.
struct Step {
  enum class Kind : std::uint8_t {
    Evaluate,  // node
    Store,     // out[buffer][position] = node
    Clear,     // out[buffer][position … position + length − 1] = 0; other steps may store there afterwards
    Result,    // result `position` of the sweep = node
  };
  Kind kind = Kind::Evaluate;
  ir::NodeId node = -1;
  int buffer = 0, position = 0, length = 0;
};

// Steps under one guard, operands before uses.
struct Unit {
  int group = -1;  // −1: always
  std::vector<Step> steps;
  bool isSwept = false;  // in the loop of the function's sweep
};

// A number of the array through which values pass from unit to unit, or, of a value that depends on the seeds, a row of the sweep's frame.
struct Slot {
  int index = -1;  // −1: the node does not leave its unit
  bool isSwept = false;
};

// Contract. Units come in an order in which they can be executed: those without a guard first, then group by group; then those of the
// sweep's loop, which holds exactly the nodes that depend on seeds, in the same order. Constants and symbols are in no unit; each unit that
// needs one makes or loads it. Every other node is in exactly one unit. A node that several groups need is evaluated always, and so is the
// sine beside a cosine that is. Of a split plan each unit is a function of its own, and values that leave their unit pass through a slot of
// an array of `slotCount` numbers or `sweptSlotCount` rows.
struct CodePlan {
  std::vector<Unit> units;
  bool isSplit = false;
  int slotCount = 0, sweptSlotCount = 0;
  std::vector<ir::NodeId> slotNodes;  // nodes that pass through a slot, ascending
  std::vector<Slot> slots;            // their slots

  [[nodiscard]] Slot slotOf(ir::NodeId node) const;
};

// A function of at most `largestUnit` steps stays whole; larger ones and those with a sweep are split into units of that size, so that
// compile time stays linear (parts of LLVM are not in the length of a block).
[[nodiscard]] CodePlan planCode(const ir::Function &function, const ir::Graph &graph, int largestUnit);

}  // namespace tf::codegen
