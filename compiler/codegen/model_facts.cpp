#include "compiler/codegen/model_facts.h"

#include <algorithm>

namespace tf::codegen {

int bindingDepth(const HybridSystem &system) {
  const auto count = system.parameterBindings.size();
  std::vector<std::vector<std::size_t>> needs(count);
  std::vector<int> depth(count, 0);
  for (std::size_t p = 0; p < count; ++p) {
    if (system.parameterBindings[p] < 0)
      continue;
    depth[p] = 1;
    const auto symbols = ir::dependencies(system.graph, std::span(&system.parameterBindings[p], 1));
    for (const ir::Symbol symbol : symbols.front())
      if (symbol.kind == ir::SymbolKind::Parameter && system.parameterBindings[static_cast<std::size_t>(symbol.index)] >= 0)
        needs[p].push_back(static_cast<std::size_t>(symbol.index));
  }
  // Bindings are acyclic and mostly in order; at most one sweep per level.
  for (std::size_t sweep = 0; sweep < count; ++sweep) {
    bool changed = false;
    for (std::size_t p = 0; p < count; ++p)
      for (const std::size_t other : needs[p])
        if (depth[p] < depth[other] + 1) {
          depth[p] = depth[other] + 1;
          changed = true;
        }
    if (!changed)
      break;
  }
  return count == 0 ? 0 : *std::max_element(depth.begin(), depth.end());
}

bool massIsConstant(const HybridSystem &system) {
  const auto varies = [](ir::Symbol symbol) { return symbol.kind != ir::SymbolKind::Parameter && symbol.kind != ir::SymbolKind::Seed; };
  return !ir::dependsOn(system.graph, system.massProduct.empty() ? system.mass : system.massProduct, varies);
}

}  // namespace tf::codegen
