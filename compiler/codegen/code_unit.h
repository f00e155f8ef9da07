// Pieces of straight-line code. Knows nothing of LLVM.
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
    Add,       // out[buffer][position] += node
    Clear,     // out[buffer][position … position + length − 1] = 0; other steps may store there afterwards
    Result,    // result `position` of the sweep = node
  };
  Kind kind = Kind::Evaluate;
  ir::NodeId node = -1;
  int buffer = 0, position = 0, length = 0;
};

// Steps under one guard, operands before uses.
struct Unit {
  int group = -1;   // −1: always
  int second = -1;  // another group that is enough; −1: none
  std::vector<Step> steps;
  bool isSwept = false;  // in the loop of the function's sweep
  bool isLate = false;   // behind it: what is added
};

// A number of the array through which values pass from unit to unit, or, of a value that depends on the seeds, a row of the sweep's frame.
struct Slot {
  int index = -1;  // −1: the node does not leave its unit
  bool isSwept = false;
};

}  // namespace tf::codegen
