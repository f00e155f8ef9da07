// Under which guards the nodes of a function are evaluated.
#pragma once

#include "compiler/ir/function.h"
#include "compiler/ir/subgraph.h"

#include <map>
#include <set>
#include <utility>
#include <vector>

namespace tf::codegen {

// What is evaluated under one guard: always, of one group, or of either of two.
struct Region {
  int group = -1, second = -1;
};

using GroupPair = std::pair<int, int>;  // ascending

// Groups of stores and sweep results from which homes follow. Beside those of the function (below `guardedCount`) there may be groups
// without a guard, of what is stored always.
struct Grouping {
  int guardedCount = 0, count = 0;
  std::vector<int> stores, results, additions;  // groups; −1: none
  bool allPairs = false;                        // nodes that two groups need may have a region of both: all such, or
  std::set<GroupPair> pairs;                    // these
};

class NodeHomes {
public:
  // `positions`: of the graph's nodes in what is reached.
  NodeHomes(const ir::Function &function, const ir::Graph &graph, const ir::Subgraph &reached, const std::vector<int> &positions,
            const Grouping &grouping);

  // Region 0 is that of what is evaluated always, then come those of the groups, then those of pairs.
  [[nodiscard]] const std::vector<Region> &regions() const { return regions_; }
  // Of a node, by its position in what is reached: that of all its users.
  [[nodiscard]] int of(std::size_t position) const { return homes_[position]; }
  void evaluateAlways(std::size_t position) { homes_[position] = 0; }
  [[nodiscard]] static int regionOfGroup(int group) { return group + 1; }
  [[nodiscard]] bool isPair(int region) const { return regions_[static_cast<std::size_t>(region)].second >= 0; }

private:
  [[nodiscard]] int meet(int a, int b);
  [[nodiscard]] int regionOfPair(GroupPair pair);

  const Grouping &grouping_;
  std::vector<Region> regions_;
  std::map<GroupPair, int> pairs_;
  std::vector<int> homes_;
};

}  // namespace tf::codegen
