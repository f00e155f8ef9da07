#include "compiler/codegen/code_plan.h"

#include "compiler/ir/subgraph.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace tf::codegen {

namespace {

using ir::NodeId;

constexpr int always = -1;
constexpr int nowhere = -2;

// Runs with at least this many zeros are cleared at once.
constexpr std::size_t shortestClear = 8;

int meet(int a, int b) {
  if (a == nowhere || a == b)
    return b;
  return b == nowhere ? a : always;
}

class Planner {
public:
  Planner(const ir::Function &function, const ir::Graph &graph, int largestUnit)
      : function_(function), graph_(graph), largestUnit_(largestUnit), reached_(graph, rootsOf(function)),
        homes_(static_cast<std::size_t>(reached_.size()), nowhere), isSwept_(homes_.size(), 0) {}

  CodePlan run() {
    findHomes();
    if (function_.sweep)
      findSwept();
    findPartners();
    order();
    std::size_t steps = 0;
    for (const Unit &region : regions_)
      steps += region.steps.size();
    plan_.isSplit = function_.sweep || steps > static_cast<std::size_t>(largestUnit_);
    for (Unit &region : regions_)
      addRegion(std::move(region));
    if (plan_.isSplit)
      assignSlots();
    return std::move(plan_);
  }

private:
  static std::vector<NodeId> rootsOf(const ir::Function &function) {
    std::vector<NodeId> roots;
    roots.reserve(function.stores.size());
    for (const ir::Store &store : function.stores)
      roots.push_back(store.node);
    if (function.sweep)
      for (const ir::Sweep::Result &result : function.sweep->results)
        roots.push_back(result.node);
    return roots;
  }

  [[nodiscard]] std::size_t position(NodeId id) const { return static_cast<std::size_t>(reached_.position(id)); }
  [[nodiscard]] bool isLeaf(NodeId id) const { return graph_[id].arity == 0; }

  // The group of which a node is a part: that of all its users.
  void findHomes() {
    for (const ir::Store &store : function_.stores)
      homes_[position(store.node)] = meet(homes_[position(store.node)], store.group);
    if (function_.sweep)
      for (const ir::Sweep::Result &result : function_.sweep->results)
        homes_[position(result.node)] = meet(homes_[position(result.node)], result.group);
    for (std::size_t k = homes_.size(); k-- > 0;) {
      const ir::Node &node = graph_[reached_.node(static_cast<int>(k))];
      for (int j = 0; j < node.arity; ++j)
        homes_[position(node.operands[j])] = meet(homes_[position(node.operands[j])], homes_[k]);
    }
  }

  void findSwept() {
    for (std::size_t k = 0; k < isSwept_.size(); ++k) {
      const ir::Node &node = graph_[reached_.node(static_cast<int>(k))];
      isSwept_[k] = node.op == ir::Op::Symbol && node.symbol.kind == ir::SymbolKind::Seed ? 1 : 0;
      for (int j = 0; j < node.arity; ++j)
        isSwept_[k] |= isSwept_[position(node.operands[j])];
    }
  }

  // Depth first from the stores: each value is computed shortly before its use. A result that no seed moves is an entry of no matrix.
  void order() {
    const auto groups = static_cast<std::size_t>(function_.groups) + 1;
    regions_.resize(function_.sweep ? 2 * groups : groups);
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      regions_[k].group = static_cast<int>(k % groups) - 1;
      regions_[k].isSwept = k >= groups;
    }
    for (const ir::Clear &clear : function_.clears)
      region(clear.group, false).steps.push_back({Step::Kind::Clear, -1, clear.buffer, clear.position, clear.length});
    const std::vector<char> isCleared = clearZeros();
    done_.assign(homes_.size(), 0);
    for (std::size_t k = 0; k < function_.stores.size(); ++k) {
      const ir::Store &store = function_.stores[k];
      if (isCleared[k] != 0)
        continue;
      visit(store.node);
      region(store.group, false).steps.push_back({Step::Kind::Store, store.node, store.buffer, store.position, 1});
    }
    for (std::size_t r = 0; function_.sweep && r < function_.sweep->results.size(); ++r) {
      const auto &[node, group] = function_.sweep->results[r];
      if (isSwept_[position(node)] == 0)
        continue;
      visit(node);
      region(group, true).steps.push_back({Step::Kind::Result, node, 0, static_cast<int>(r), 1});
    }
  }

  Unit &region(int group, bool isSwept) {
    const int number = group + 1 + (isSwept ? function_.groups + 1 : 0);
    return regions_[static_cast<std::size_t>(number)];
  }

  // Begins regions with the clearing of their zeros. Returns which stores are done with that.
  std::vector<char> clearZeros() {
    const std::vector<ir::Store> &stores = function_.stores;
    std::vector<char> isCleared(stores.size(), 0);
    std::vector<std::size_t> order(stores.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto place = [&](std::size_t k) { return std::tuple(stores[k].group, stores[k].buffer, stores[k].position); };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
    const auto follows = [&](std::size_t a, std::size_t b) {
      return stores[a].group == stores[b].group && stores[a].buffer == stores[b].buffer && stores[a].position + 1 == stores[b].position;
    };
    const auto isZero = [&](std::size_t k) { return graph_.isConstant(stores[k].node, 0) && !std::signbit(graph_[stores[k].node].value); };
    // A run goes on over a few other values, which are written twice, but not over as many as make a run of zeros.
    for (std::size_t first = 0; first < order.size(); ++first) {
      if (!isZero(order[first]))
        continue;
      std::size_t last = first;
      std::size_t zeros = 1;
      for (std::size_t next = first + 1; next < order.size() && follows(order[next - 1], order[next]) && next - last <= shortestClear;
           ++next)
        if (isZero(order[next])) {
          last = next;
          ++zeros;
        }
      if (zeros >= shortestClear) {
        const ir::Store &begin = stores[order[first]];
        region(begin.group, false)
            .steps.push_back({Step::Kind::Clear, -1, begin.buffer, begin.position, static_cast<int>(last - first) + 1});
        for (std::size_t k = first; k <= last; ++k)
          isCleared[order[k]] = isZero(order[k]) ? 1 : 0;
      }
      first = last;
    }
    return isCleared;
  }

  void visit(NodeId root) {
    std::vector<std::pair<NodeId, int>> path{{root, 0}};
    while (!path.empty()) {
      auto &[id, next] = path.back();
      const ir::Node &node = graph_[id];
      if (next == 0 && (isLeaf(id) || done_[position(id)] != 0)) {
        path.pop_back();
      } else if (next < node.arity) {
        path.emplace_back(node.operands[next++], 0);
      } else {
        evaluateHere(id);
        if (const auto partner = partners_.find(id);
            partner != partners_.end() && homes_[position(partner->second)] == homes_[position(id)])
          evaluateHere(partner->second);
        path.pop_back();
      }
    }
  }

  void evaluateHere(NodeId id) {
    if (done_[position(id)] == 0)
      region(homes_[position(id)], isSwept_[position(id)] != 0).steps.push_back({Step::Kind::Evaluate, id, 0, 0, 0});
    done_[position(id)] = 1;
  }

  // Sine and cosine of the same argument are evaluated side by side, where one call gives both: it costs hardly more than one of them, so
  // that a partner follows the other out of its group.
  void findPartners() {
    std::unordered_map<NodeId, NodeId> firstOf;  // by argument
    for (const NodeId id : reached_.nodes()) {
      const ir::Node &node = graph_[id];
      if (node.op != ir::Op::Sin && node.op != ir::Op::Cos)
        continue;
      const auto [first, isNew] = firstOf.emplace(node.operands[0], id);
      if (!isNew) {
        partners_[id] = first->second;
        partners_[first->second] = id;
      }
    }
    for (const auto &[id, partner] : partners_)
      if (homes_[position(id)] == always)
        homes_[position(partner)] = always;
  }

  void addRegion(Unit region) {
    const std::size_t size = plan_.isSplit ? static_cast<std::size_t>(largestUnit_) : region.steps.size();
    for (std::size_t begin = 0; begin < region.steps.size(); begin += size) {
      const auto first = region.steps.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto last = region.steps.begin() + static_cast<std::ptrdiff_t>(std::min(begin + size, region.steps.size()));
      plan_.units.push_back({region.group, {first, last}, region.isSwept});
    }
  }

  // Linear scan over the units: a slot is free again after the last unit that reads it; one that the loop reads, after the loop.
  void assignSlots() {
    const int unitCount = static_cast<int>(plan_.units.size());
    std::vector<int> lastUse(homes_.size(), -1);
    for (int u = 0; u < unitCount; ++u)
      for (const Step &step : plan_.units[static_cast<std::size_t>(u)].steps)
        noteUses(step, u, lastUse);
    std::vector<std::vector<Slot>> freed(static_cast<std::size_t>(unitCount) + 1);
    std::vector<int> free[2];  // of the numbers, of the rows
    int *const counts[2] = {&plan_.slotCount, &plan_.sweptSlotCount};
    std::vector<std::pair<NodeId, Slot>> assigned;
    for (int u = 0; u < unitCount; ++u) {
      for (const Slot slot : freed[static_cast<std::size_t>(u)])
        free[slot.isSwept ? 1 : 0].push_back(slot.index);
      for (const Step &step : plan_.units[static_cast<std::size_t>(u)].steps) {
        if (step.kind != Step::Kind::Evaluate || lastUse[position(step.node)] <= u)
          continue;
        const std::size_t pool = isSwept_[position(step.node)] != 0 ? 1 : 0;
        const Slot slot{free[pool].empty() ? (*counts[pool])++ : free[pool].back(), pool == 1};
        if (!free[pool].empty())
          free[pool].pop_back();
        assigned.emplace_back(step.node, slot);
        freed[static_cast<std::size_t>(lastUse[position(step.node)]) + 1].push_back(slot);
      }
    }
    std::sort(assigned.begin(), assigned.end(), [](const auto &a, const auto &b) { return a.first < b.first; });
    for (const auto &[node, slot] : assigned) {
      plan_.slotNodes.push_back(node);
      plan_.slots.push_back(slot);
    }
  }

  void noteUses(const Step &step, int unit, std::vector<int> &lastUse) {
    const bool isInLoop = plan_.units[static_cast<std::size_t>(unit)].isSwept;
    const auto use = [&](NodeId id) {
      const bool isFromOutside = isInLoop && isSwept_[position(id)] == 0;
      lastUse[position(id)] = isFromOutside ? static_cast<int>(plan_.units.size()) - 1 : unit;
    };
    if (step.kind == Step::Kind::Store || step.kind == Step::Kind::Result)
      use(step.node);
    if (step.kind != Step::Kind::Evaluate)
      return;
    const ir::Node &node = graph_[step.node];
    for (int j = 0; j < node.arity; ++j)
      use(node.operands[j]);
  }

  const ir::Function &function_;
  const ir::Graph &graph_;
  int largestUnit_;
  ir::Subgraph reached_;
  std::vector<int> homes_;
  std::vector<char> isSwept_;  // depends on seeds
  std::vector<char> done_;
  std::vector<Unit> regions_;
  std::unordered_map<NodeId, NodeId> partners_;
  CodePlan plan_;
};

}  // namespace

Slot CodePlan::slotOf(ir::NodeId node) const {
  const auto found = std::lower_bound(slotNodes.begin(), slotNodes.end(), node);
  return found != slotNodes.end() && *found == node ? slots[static_cast<std::size_t>(found - slotNodes.begin())] : Slot{};
}

CodePlan planCode(const ir::Function &function, const ir::Graph &graph, int largestUnit) {
  assert(ir::verify(function, graph).empty());
  return Planner(function, graph, largestUnit).run();
}

}  // namespace tf::codegen
