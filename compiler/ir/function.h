// A function to be generated: named outputs, each an array of nodes; rows may belong to a guarded group.
#pragma once

#include "compiler/ir/graph.h"

#include <string>
#include <vector>

namespace tf::ir {

// out[buffer][position] = node, evaluated and stored only where mask[group] != 0 (group −1: always).
struct Store {
  int buffer = 0;
  int position = 0;
  NodeId node = -1;
  int group = -1;
};

// Contract: nodes are roots in the graph passed beside it; every position of a buffer is stored at most once; groups are numbered from 0
// below `groups`. Nodes reachable from stores of one group only are evaluated under its guard; those of several groups, always.
struct Function {
  std::string name;
  std::vector<int> bufferSizes;
  int groups = 0;
  std::vector<Store> stores;
};

// Readable listing of definitions and stores.
[[nodiscard]] std::string print(const Function &function, const Graph &graph, const std::function<std::string(Symbol)> &name);
[[nodiscard]] std::string verify(const Function &function, const Graph &graph);

}  // namespace tf::ir
