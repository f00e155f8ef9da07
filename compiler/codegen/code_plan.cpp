#include "compiler/codegen/code_plan.h"

#include "compiler/ir/subgraph.h"

#include <algorithm>
#include <cassert>
#include <unordered_map>
#include <utility>

namespace tf::codegen {

namespace {

using ir::NodeId;

constexpr int always = -1;
constexpr int nowhere = -2;

int meet(int a, int b) {
  if (a == nowhere || a == b)
    return b;
  return b == nowhere ? a : always;
}

class Planner {
public:
  Planner(const ir::Function &function, const ir::Graph &graph, int largestUnit)
      : function_(function), graph_(graph), largestUnit_(largestUnit), reached_(graph, rootsOf(function)),
        homes_(static_cast<std::size_t>(reached_.size()), nowhere) {}

  CodePlan run() {
    findHomes();
    findPartners();
    order();
    int steps = 0;
    for (const Unit &region : regions_)
      steps += static_cast<int>(region.steps.size());
    plan_.isSplit = steps > largestUnit_;
    for (Unit &region : regions_)
      addRegion(std::move(region));
    if (plan_.isSplit)
      assignSlots();
    return std::move(plan_);
  }

private:
  static std::vector<NodeId> rootsOf(const ir::Function &function) {
    std::vector<NodeId> roots;
    for (const ir::Store &store : function.stores)
      roots.push_back(store.node);
    return roots;
  }

  [[nodiscard]] std::size_t position(NodeId id) const { return static_cast<std::size_t>(reached_.position(id)); }
  [[nodiscard]] bool isLeaf(NodeId id) const { return graph_[id].arity == 0; }

  // The group of which a node is a part: that of all its users.
  void findHomes() {
    for (const ir::Store &store : function_.stores)
      homes_[position(store.node)] = meet(homes_[position(store.node)], store.group);
    for (std::size_t k = homes_.size(); k-- > 0;) {
      const ir::Node &node = graph_[reached_.node(static_cast<int>(k))];
      for (int j = 0; j < node.arity; ++j)
        homes_[position(node.operands[j])] = meet(homes_[position(node.operands[j])], homes_[k]);
    }
  }

  // Depth first from the stores: each value is computed shortly before its use.
  void order() {
    regions_.resize(static_cast<std::size_t>(function_.groups) + 1);
    for (std::size_t g = 0; g < regions_.size(); ++g)
      regions_[g].group = static_cast<int>(g) - 1;
    done_.assign(homes_.size(), 0);
    for (const ir::Store &store : function_.stores) {
      visit(store.node);
      regions_[static_cast<std::size_t>(store.group + 1)].steps.push_back({store.node, &store});
    }
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
      regions_[static_cast<std::size_t>(homes_[position(id)] + 1)].steps.push_back({id, nullptr});
    done_[position(id)] = 1;
  }

  // Sine and cosine of the same argument are evaluated side by side, where the back end makes one call of the two.
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
  }

  void addRegion(Unit region) {
    const std::size_t size = plan_.isSplit ? static_cast<std::size_t>(largestUnit_) : region.steps.size();
    for (std::size_t begin = 0; begin < region.steps.size(); begin += size) {
      const auto first = region.steps.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto last = region.steps.begin() + static_cast<std::ptrdiff_t>(std::min(begin + size, region.steps.size()));
      plan_.units.push_back({region.group, {first, last}});
    }
  }

  // Linear scan over the units: a slot is free again after the last unit that reads it.
  void assignSlots() {
    const int unitCount = static_cast<int>(plan_.units.size());
    std::vector<int> lastUse(homes_.size(), -1);
    for (int u = 0; u < unitCount; ++u)
      for (const Step &step : plan_.units[static_cast<std::size_t>(u)].steps)
        noteUses(step, u, lastUse);
    std::vector<std::vector<int>> freed(static_cast<std::size_t>(unitCount) + 1);
    std::vector<int> free;
    std::vector<std::pair<NodeId, int>> assigned;
    for (int u = 0; u < unitCount; ++u) {
      for (const int slot : freed[static_cast<std::size_t>(u)])
        free.push_back(slot);
      for (const Step &step : plan_.units[static_cast<std::size_t>(u)].steps) {
        if (step.store != nullptr || lastUse[position(step.node)] <= u)
          continue;
        const int slot = free.empty() ? plan_.slotCount++ : free.back();
        if (!free.empty())
          free.pop_back();
        assigned.emplace_back(step.node, slot);
        freed[static_cast<std::size_t>(lastUse[position(step.node)]) + 1].push_back(slot);
      }
    }
    std::sort(assigned.begin(), assigned.end());
    for (const auto &[node, slot] : assigned) {
      plan_.slotNodes.push_back(node);
      plan_.slots.push_back(slot);
    }
  }

  void noteUses(const Step &step, int unit, std::vector<int> &lastUse) {
    if (step.store != nullptr) {
      lastUse[position(step.node)] = unit;
      return;
    }
    const ir::Node &node = graph_[step.node];
    for (int j = 0; j < node.arity; ++j)
      lastUse[position(node.operands[j])] = unit;
  }

  const ir::Function &function_;
  const ir::Graph &graph_;
  int largestUnit_;
  ir::Subgraph reached_;
  std::vector<int> homes_;
  std::vector<char> done_;
  std::vector<Unit> regions_;
  std::unordered_map<NodeId, NodeId> partners_;
  CodePlan plan_;
};

}  // namespace

int CodePlan::slotOf(ir::NodeId node) const {
  const auto found = std::lower_bound(slotNodes.begin(), slotNodes.end(), node);
  return found != slotNodes.end() && *found == node ? slots[static_cast<std::size_t>(found - slotNodes.begin())] : -1;
}

CodePlan planCode(const ir::Function &function, const ir::Graph &graph, int largestUnit) {
  assert(ir::verify(function, graph).empty());
  return Planner(function, graph, largestUnit).run();
}

}  // namespace tf::codegen
