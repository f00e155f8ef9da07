// How a function is laid out: what is evaluated under which guard, in which order, in pieces of bounded size. Knows nothing of LLVM.
#pragma once

#include "compiler/codegen/loop_tables.h"

#include <vector>

namespace tf::codegen {

// Units that follow one another and are of one shape (unit_shape.h): their code is there once, in a loop over what they differ in.
struct Repetition {
  int first = 0, count = 0;
  LoopTables tables;
};

// Contract. Units come in an order in which they can be executed: those without a guard first, then those of two groups, then group by
// group; then those of the sweep's loop, which holds exactly the nodes that depend on seeds, in the same order; then what is added.
// Constants and symbols are in no unit; each unit that needs one makes or loads it. Every other node is in exactly one unit. A node that
// several groups need is evaluated always, and so is the sine beside a cosine that is. Of a split plan each unit is a function of its own,
// or repeated; values that leave their unit pass through a slot of an array of `slotCount` numbers or `sweptSlotCount` rows; nodes that two
// groups need are under a guard of both where many such units are alike; and what is stored always is in units of its own where many of
// these are.
struct CodePlan {
  std::vector<Unit> units;
  std::vector<Repetition> repetitions;  // ascending; no units in common
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
