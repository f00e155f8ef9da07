#include "compiler/codegen/node_homes.h"

#include <algorithm>

namespace tf::codegen {

namespace {

constexpr int nowhere = -1;

}  // namespace

NodeHomes::NodeHomes(const ir::Function &function, const ir::Graph &graph, const ir::Subgraph &reached, const std::vector<int> &positions,
                     const Grouping &grouping)
    : grouping_(grouping), regions_(1), homes_(static_cast<std::size_t>(reached.size()), nowhere) {
  for (int group = 0; group < grouping.count; ++group)
    regions_.push_back({group, -1});
  const auto use = [&](ir::NodeId node, int region) {
    int &home = homes_[static_cast<std::size_t>(positions[static_cast<std::size_t>(node)])];
    home = meet(home, region);
  };
  for (std::size_t k = 0; k < function.stores.size(); ++k)
    use(function.stores[k].node, regionOfGroup(grouping.stores[k]));
  for (std::size_t k = 0; function.sweep && k < function.sweep->results.size(); ++k)
    use(function.sweep->results[k].node, regionOfGroup(grouping.results[k]));
  for (std::size_t k = 0; k < function.additions.size(); ++k)
    use(function.additions[k].node, regionOfGroup(grouping.additions[k]));
  for (std::size_t k = homes_.size(); k-- > 0;) {
    const ir::Node &node = graph[reached.node(static_cast<int>(k))];
    for (int j = 0; j < node.arity; ++j)
      use(node.operands[j], homes_[k]);
  }
}

// The least region that both are parts of.
int NodeHomes::meet(int a, int b) {
  if (a == nowhere || a == b)
    return b;
  if (b == nowhere)
    return a;
  if (a == 0 || b == 0)
    return 0;
  // At most two groups together.
  const Region one = regions_[static_cast<std::size_t>(a)], other = regions_[static_cast<std::size_t>(b)];
  Region both = one;
  for (const int group : {other.group, other.second}) {
    if (group < 0 || group == both.group || group == both.second)
      continue;
    if (both.second >= 0)
      return 0;
    both.second = group;
  }
  return both.second < 0 ? a : regionOfPair(std::minmax(both.group, both.second));
}

// A guard is of no use for what is stored always.
int NodeHomes::regionOfPair(GroupPair pair) {
  const bool isMixed = pair.first < grouping_.guardedCount && pair.second >= grouping_.guardedCount;
  if (isMixed || !(grouping_.allPairs || grouping_.pairs.contains(pair)))
    return 0;
  const auto [known, isNew] = pairs_.emplace(pair, static_cast<int>(regions_.size()));
  if (isNew)
    regions_.push_back({pair.first, pair.second});
  return known->second;
}

}  // namespace tf::codegen
