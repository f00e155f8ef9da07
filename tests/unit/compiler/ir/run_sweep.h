// What a function's clears and sweep store, by the interpreter: the meaning that ir/function.h gives them, for tests.
#pragma once

#include "compiler/ir/function.h"

#include <algorithm>
#include <vector>

namespace tf::ir::testing {

// `outputs`: one array per buffer. An empty mask selects everything.
inline void runSweep(const Function &function, const Graph &graph, const std::function<double(Symbol)> &value,
                     const std::vector<std::uint8_t> &mask, std::vector<std::vector<double>> &outputs) {
  const auto isSelected = [&](int group) { return group < 0 || mask.empty() || mask[static_cast<std::size_t>(group)] != 0; };
  for (const Clear &clear : function.clears)
    if (isSelected(clear.group))
      std::fill_n(outputs[static_cast<std::size_t>(clear.buffer)].begin() + clear.position, clear.length, 0.0);
  if (!function.sweep)
    return;
  std::vector<NodeId> nodes;
  for (const Sweep::Result &result : function.sweep->results)
    nodes.push_back(result.node);
  for (const Sweep::Colour &colour : function.sweep->colours) {
    const std::vector<double> results = evaluate(graph, nodes, [&](Symbol symbol) {
      if (symbol.kind != SymbolKind::Seed)
        return value(symbol);
      return std::ranges::count(colour.seeds, symbol.index) > 0 ? 1.0 : 0.0;
    });
    for (const Sweep::Run &run : colour.runs)
      for (int k = 0; k < run.count; ++k) {
        const auto result = static_cast<std::size_t>(run.first + k);
        if (isSelected(run.group) && isSelected(function.sweep->results[result].group))
          outputs[static_cast<std::size_t>(run.buffer)][static_cast<std::size_t>(run.position + k * run.stride)] = results[result];
      }
  }
}

}  // namespace tf::ir::testing
