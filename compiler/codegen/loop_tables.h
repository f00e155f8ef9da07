// The numbers in which the units of a repetition differ, as tables with a row for each unit.
#pragma once

#include "compiler/codegen/unit_shape.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tf::codegen {

// Where a number comes from: column `column` of the unit's row, plus `offset`; without a column it is `offset` in all units.
struct WholeSource {
  int column = -1;
  std::int64_t offset = 0;
};
// The same of constants, without offsets.
struct RealSource {
  int column = -1;
  double value = 0;
};

// So many flags of groups are read at a time.
inline constexpr std::array flagWidths = {64, 8};

struct LoopTables {
  std::vector<Place> places;        // of the first unit
  std::vector<WholeSource> wholes;  // of each place (of no use for constants)
  std::vector<RealSource> reals;    // of each place (of use for constants)
  WholeSource group, second;        // of the guard; −1: none
  std::vector<std::int32_t> wholeRows;
  std::vector<double> realRows;
  int wholeColumns = 0, realColumns = 0;
  // Of guarded units, for each of flagWidths: by how many rows to go on if so many flags from that of the group on, and from that of the
  // second group on, are zero.
  std::array<WholeSource, flagWidths.size()> skips;
};

// `units` are of one shape; `slotOf` gives the slots' numbers.
[[nodiscard]] LoopTables tabulate(std::span<const Unit> units, const ir::Graph &graph, const ShapeContext &context,
                                  const std::function<int(ir::NodeId)> &slotOf);

}  // namespace tf::codegen
