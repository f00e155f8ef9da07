// A function to be generated: named outputs, each an array of nodes; rows may belong to a guarded group.
#pragma once

#include "compiler/ir/graph.h"

#include <optional>
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

// out[buffer][position … position + length − 1] = 0 where mask[group] != 0, before anything else is stored there.
struct Clear {
  int buffer = 0;
  int position = 0;
  int length = 0;
  int group = -1;
};

// A matrix by a loop over directions instead of an expression for each entry: code of the size of one directional derivative, whatever the
// number of entries. The results are linear in the symbols Seed 0 … seedCount − 1. They are evaluated once for each colour, with the seeds
// of that colour 1 and all others 0, and stored by the colour's runs (Curtis, Powell, Reid, On the estimation of sparse Jacobian matrices,
// 1974). Seeds of one colour have no result in common, so that each result is an entry of the matrix.
struct Sweep {
  // That are followed at once: columns of the arrays of directions and products, TF_DIRECTIONS of the model's interface.
  static constexpr int directions = 8;

  struct Result {
    NodeId node = -1;
    int group = -1;  // evaluated and stored where mask[group] != 0
  };
  // out[buffer][position + k·stride] = results[first + k] for k < count, where mask[group] != 0.
  struct Run {
    int first = 0, count = 0;
    int buffer = 0, position = 0, stride = 1;
    int group = -1;
    bool operator==(const Run &) const = default;
  };
  struct Colour {
    std::vector<int> seeds;
    std::vector<Run> runs;
  };
  int seedCount = 0;
  std::vector<Result> results;
  std::vector<Colour> colours;
  // Instead of the runs, where a mask is given to a function without groups: out[products] = the results along the directions that the
  // caller gives (TF_IN_DIRECTIONS), a row of `directions` numbers for each; −1: never.
  int products = -1;
};

// Contract: nodes are roots in the graph passed beside it; every position of a buffer is stored at most once; groups are numbered from 0
// below `groups`. Nodes reachable from stores of one group only are evaluated under its guard; those of several groups, always, or where
// one of them is selected. Stores and additions do not depend on seeds.
struct Function {
  std::string name;
  std::vector<int> bufferSizes;
  int groups = 0;
  std::vector<Store> stores;
  std::vector<Clear> clears{};
  std::vector<Store> additions{};  // out[buffer][position] += node, in any order, when all else has been stored
  std::optional<Sweep> sweep{};
};

// Readable listing of definitions and stores.
[[nodiscard]] std::string print(const Function &function, const Graph &graph, const std::function<std::string(Symbol)> &name);
[[nodiscard]] std::string verify(const Function &function, const Graph &graph);

}  // namespace tf::ir
