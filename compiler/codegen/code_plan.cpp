#include "compiler/codegen/code_plan.h"

#include "compiler/codegen/node_homes.h"
#include "compiler/codegen/unit_shape.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace tf::codegen {

namespace {

using ir::NodeId;

constexpr int always = -1;

// Runs with at least this many zeros are cleared at once.
constexpr std::size_t shortestClear = 8;

// So many regions of one shape are a repetition, if they save so many steps of code.
constexpr std::size_t fewestAlike = 4, leastSaving = 50;
constexpr std::size_t longestRepeated = 20000;  // steps: of one function, which LLVM takes longer for than for several

class Planner {
public:
  Planner(const ir::Function &function, const ir::Graph &graph, int largestUnit)
      : function_(function), graph_(graph), largestUnit_(largestUnit), reached_(graph, rootsOf(function)),
        isSwept_(static_cast<std::size_t>(reached_.size()), 0), likenesses_(likenesses(graph, reached_)),
        positions_(static_cast<std::size_t>(graph.size()), -1) {
    for (int k = 0; k < reached_.size(); ++k)
      positions_[static_cast<std::size_t>(reached_.node(k))] = k;
  }

  CodePlan run() {
    if (function_.sweep)
      findSwept();
    if (!function_.additions.empty())
      findLate();
    findPartners();
    isCleared_ = findClears();
    layOut(givenGrouping());
    plan_.isSplit = function_.sweep || stepCount() > static_cast<std::size_t>(largestUnit_);
    if (plan_.isSplit)
      repeat();
    addRegions();
    if (plan_.isSplit)
      assignSlots();
    fillTables();
    return std::move(plan_);
  }

private:
  static std::vector<NodeId> rootsOf(const ir::Function &function) {
    std::vector<NodeId> roots;
    roots.reserve(function.stores.size());
    for (const ir::Store &store : function.stores)
      roots.push_back(store.node);
    for (const ir::Store &addition : function.additions)
      roots.push_back(addition.node);
    if (function.sweep)
      for (const ir::Sweep::Result &result : function.sweep->results)
        roots.push_back(result.node);
    return roots;
  }

  [[nodiscard]] std::size_t position(NodeId id) const { return static_cast<std::size_t>(positions_[static_cast<std::size_t>(id)]); }
  [[nodiscard]] bool isLeaf(NodeId id) const { return graph_[id].arity == 0; }
  [[nodiscard]] bool isSwept(NodeId id) const { return isSwept_[position(id)] != 0; }
  [[nodiscard]] std::size_t stepCount() const {
    return std::accumulate(regions_.begin(), regions_.end(), std::size_t{0},
                           [](std::size_t sum, const Unit &region) { return sum + region.steps.size(); });
  }

  [[nodiscard]] Grouping givenGrouping() const {
    Grouping grouping;
    grouping.guardedCount = grouping.count = function_.groups;
    for (const ir::Store &store : function_.stores)
      grouping.stores.push_back(store.group);
    for (const ir::Store &addition : function_.additions)
      grouping.additions.push_back(addition.group);
    for (std::size_t k = 0; function_.sweep && k < function_.sweep->results.size(); ++k)
      grouping.results.push_back(function_.sweep->results[k].group);
    return grouping;
  }

  // Each store without a guard has a group of its own.
  [[nodiscard]] Grouping finestGrouping() const {
    Grouping grouping = givenGrouping();
    const auto single = [&grouping](int &group) {
      if (group < 0)
        group = grouping.count++;
    };
    for (std::size_t k = 0; k < grouping.stores.size(); ++k)
      if (isCleared_[k] == 0)
        single(grouping.stores[k]);
    std::ranges::for_each(grouping.results, single);
    grouping.allPairs = true;
    return grouping;
  }

  // Looks for regions that are alike with the finest grouping; what is alike is laid out so, and all else as it is given.
  void repeat() {
    Grouping grouping = finestGrouping();
    layOut(grouping);
    std::vector<char> isAlike(static_cast<std::size_t>(grouping.count), 0);
    grouping.allPairs = false;
    for (const std::vector<std::size_t> &family : findFamilies())
      for (const std::size_t number : family)
        if (const Unit &region = regions_[number]; region.second >= 0)
          grouping.pairs.emplace(region.group, region.second);
        else
          isAlike[static_cast<std::size_t>(region.group)] = 1;
    const auto join = [&](int &group) {
      if (group >= grouping.guardedCount && isAlike[static_cast<std::size_t>(group)] == 0)
        group = always;
    };
    std::ranges::for_each(grouping.stores, join);
    std::ranges::for_each(grouping.results, join);
    layOut(grouping);
    families_ = findFamilies();
  }

  // Regions of one shape, each ascending; their places become those of their first ones.
  [[nodiscard]] std::vector<std::vector<std::size_t>> findFamilies() const {
    const std::vector<char> leaves = findLeaving();
    const ShapeContext context = shapeContext([&](NodeId id) { return leaves[position(id)] != 0; });
    std::map<std::vector<std::int64_t>, std::vector<std::size_t>> regionsOf;
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      const Unit &region = regions_[k];
      if (region.group < 0 || region.steps.empty() || region.steps.size() > longestRepeated)
        continue;
      std::vector<std::int64_t> key = shapeOf(region, graph_, context).code;
      // Those of a loop are executed one after the other.
      key.push_back(region.isSwept ? Swept : region.isLate ? Late : Early);
      key.push_back(region.second >= 0 ? 1 : 0);
      key.push_back(region.group < function_.groups ? 1 : 0);
      regionsOf[std::move(key)].push_back(k);
    }
    std::vector<std::vector<std::size_t>> families;
    for (const auto &[key, family] : regionsOf)
      if (family.size() >= fewestAlike && (family.size() - 1) * regions_[family.front()].steps.size() >= leastSaving)
        families.push_back(family);
    std::ranges::sort(families);
    return families;
  }

  [[nodiscard]] ShapeContext shapeContext(std::function<bool(NodeId)> leaves) const {
    return {std::move(leaves), [this](NodeId id) { return isSwept(id); }, likeness_};
  }

  void fillTables() {
    const ShapeContext context = shapeContext([this](NodeId id) { return plan_.slotOf(id).index >= 0; });
    for (Repetition &repetition : plan_.repetitions)
      repetition.tables =
          tabulate(std::span(plan_.units).subspan(static_cast<std::size_t>(repetition.first), static_cast<std::size_t>(repetition.count)),
                   graph_, context, [this](NodeId id) { return plan_.slotOf(id).index; });
  }

  // Nodes that are used in another region than their own.
  [[nodiscard]] std::vector<char> findLeaving() const {
    std::vector<char> leaves(isSwept_.size(), 0);
    const auto use = [&](NodeId id, std::size_t region) {
      if (regionOf_[position(id)] != region)
        leaves[position(id)] = 1;
    };
    for (std::size_t k = 0; k < regions_.size(); ++k)
      for (const Step &step : regions_[k].steps) {
        if (step.kind != Step::Kind::Evaluate && step.kind != Step::Kind::Clear)
          use(step.node, k);
        for (int j = 0; step.kind == Step::Kind::Evaluate && j < graph_[step.node].arity; ++j)
          use(graph_[step.node].operands[j], k);
      }
    return leaves;
  }

  void findSwept() {
    for (std::size_t k = 0; k < isSwept_.size(); ++k) {
      const ir::Node &node = graph_[reached_.node(static_cast<int>(k))];
      isSwept_[k] = node.op == ir::Op::Symbol && node.symbol.kind == ir::SymbolKind::Seed ? 1 : 0;
      for (int j = 0; j < node.arity; ++j)
        isSwept_[k] |= isSwept_[position(node.operands[j])];
    }
  }

  // What is needed for additions only.
  void findLate() {
    isLate_.assign(isSwept_.size(), 1);
    const auto useEarly = [this](NodeId id) { isLate_[position(id)] = 0; };
    for (const ir::Store &store : function_.stores)
      useEarly(store.node);
    for (std::size_t k = 0; function_.sweep && k < function_.sweep->results.size(); ++k)
      useEarly(function_.sweep->results[k].node);
    for (std::size_t k = isLate_.size(); k-- > 0;)
      if (const ir::Node &node = graph_[reached_.node(static_cast<int>(k))]; isLate_[k] == 0)
        std::for_each_n(node.operands, node.arity, useEarly);
  }

  // Depth first from the stores: each value is computed shortly before its use. A result that no seed moves is an entry of no matrix.
  void layOut(const Grouping &grouping) {
    NodeHomes homes(function_, graph_, reached_, positions_, grouping);
    for (const auto &[id, partner] : partners_)
      if (homes.of(position(id)) == 0)
        homes.evaluateAlways(position(partner));
    homes_ = &homes;
    const std::size_t count = homes.regions().size();
    regions_.assign(3 * count, {});
    for (std::size_t k = 0; k < regions_.size(); ++k) {
      regions_[k].group = homes.regions()[k % count].group;
      regions_[k].second = homes.regions()[k % count].second;
      regions_[k].isSwept = k / count == Swept;
      regions_[k].isLate = k / count == Late;
    }
    const auto regionOf = [&](int group, Phase phase) -> Unit & {
      return regions_[static_cast<std::size_t>(NodeHomes::regionOfGroup(group)) + phase * count];
    };
    for (const GroupClear &clear : clears_)
      regionOf(clear.group, Early).steps.push_back(clear.step);
    regionOf_.assign(isSwept_.size(), undone);
    for (std::size_t k = 0; k < function_.stores.size(); ++k) {
      const ir::Store &store = function_.stores[k];
      if (isCleared_[k] != 0)
        continue;
      visit(store.node);
      regionOf(grouping.stores[k], Early).steps.push_back({Step::Kind::Store, store.node, store.buffer, store.position, 1});
    }
    for (std::size_t r = 0; function_.sweep && r < function_.sweep->results.size(); ++r) {
      const NodeId node = function_.sweep->results[r].node;
      if (!isSwept(node))
        continue;
      visit(node);
      regionOf(grouping.results[r], Swept).steps.push_back({Step::Kind::Result, node, 0, static_cast<int>(r), 1});
    }
    for (std::size_t k = 0; k < function_.additions.size(); ++k) {
      const ir::Store &addition = function_.additions[k];
      visit(addition.node);
      regionOf(grouping.additions[k], Late).steps.push_back({Step::Kind::Add, addition.node, addition.buffer, addition.position, 1});
    }
    homes_ = nullptr;
  }

  // Regions begin with the clearing of their zeros. Returns which stores are done with that.
  std::vector<char> findClears() {
    const std::vector<ir::Store> &stores = function_.stores;
    for (const ir::Clear &clear : function_.clears)
      clears_.push_back({clear.group, {Step::Kind::Clear, -1, clear.buffer, clear.position, clear.length}});
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
        clears_.push_back({begin.group, {Step::Kind::Clear, -1, begin.buffer, begin.position, static_cast<int>(last - first) + 1}});
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
      if (next == 0 && (isLeaf(id) || regionOf_[position(id)] != undone)) {
        path.pop_back();
      } else if (next < node.arity) {
        path.emplace_back(alignedOperands(node, likeness_)[static_cast<std::size_t>(next++)], 0);
      } else {
        evaluateHere(id);
        if (const auto partner = partners_.find(id);
            partner != partners_.end() && homes_->of(position(partner->second)) == homes_->of(position(id)))
          evaluateHere(partner->second);
        path.pop_back();
      }
    }
  }

  void evaluateHere(NodeId id) {
    std::size_t &region = regionOf_[position(id)];
    if (region != undone)
      return;
    const Phase phase = isSwept(id) ? Swept : !isLate_.empty() && isLate_[position(id)] != 0 ? Late : Early;
    region = static_cast<std::size_t>(homes_->of(position(id))) + phase * homes_->regions().size();
    regions_[region].steps.push_back({Step::Kind::Evaluate, id, 0, 0, 0});
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
  }

  // In an order in which they can be executed; those that are alike one after the other.
  void addRegions() {
    std::vector<std::size_t> order(regions_.size()), placeOf(regions_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::iota(placeOf.begin(), placeOf.end(), std::size_t{0});
    for (const std::vector<std::size_t> &family : families_)
      for (const std::size_t member : family)
        placeOf[member] = family.front();
    const auto rank = [&](std::size_t k) {
      const Unit &region = regions_[k];
      return std::tuple(region.isLate, region.isSwept, region.group < 0 ? 0 : region.second >= 0 ? 1 : 2, placeOf[k], k);
    };
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
    std::map<std::size_t, std::size_t> sizeOf;
    for (const std::vector<std::size_t> &family : families_)
      sizeOf[family.front()] = family.size();
    for (const std::size_t k : order) {
      const auto family = sizeOf.find(placeOf[k]);
      if (family == sizeOf.end()) {
        addRegion(withoutGroups(std::move(regions_[k])));
        continue;
      }
      if (k == placeOf[k])
        plan_.repetitions.push_back({static_cast<int>(plan_.units.size()), static_cast<int>(family->second), {}});
      plan_.units.push_back(withoutGroups(std::move(regions_[k])));
    }
  }

  // Groups beside those of the function have no guard.
  [[nodiscard]] Unit withoutGroups(Unit unit) const {
    if (unit.group >= function_.groups)
      unit.group = unit.second = always;
    return unit;
  }

  void addRegion(Unit region) {
    const std::size_t size = plan_.isSplit ? static_cast<std::size_t>(largestUnit_) : region.steps.size();
    for (std::size_t begin = 0; begin < region.steps.size(); begin += size) {
      const auto first = region.steps.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto last = region.steps.begin() + static_cast<std::ptrdiff_t>(std::min(begin + size, region.steps.size()));
      plan_.units.push_back({region.group, region.second, {first, last}, region.isSwept, region.isLate});
    }
  }

  // Linear scan over the units: a slot is free again after the last unit that reads it; one that the loop reads, after the loop.
  void assignSlots() {
    const int unitCount = static_cast<int>(plan_.units.size());
    std::vector<int> lastUse(isSwept_.size(), -1);
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
    if (step.kind != Step::Kind::Evaluate && step.kind != Step::Kind::Clear)
      use(step.node);
    if (step.kind != Step::Kind::Evaluate)
      return;
    const ir::Node &node = graph_[step.node];
    for (int j = 0; j < node.arity; ++j)
      use(node.operands[j]);
  }

  // What is cleared under the guard of a group.
  struct GroupClear {
    int group = -1;
    Step step;
  };
  // When regions are executed.
  enum Phase : std::size_t { Early, Swept, Late };
  static constexpr std::size_t undone = std::numeric_limits<std::size_t>::max();

  const ir::Function &function_;
  const ir::Graph &graph_;
  int largestUnit_;
  ir::Subgraph reached_;
  std::vector<char> isSwept_;  // depends on seeds
  std::vector<char> isLate_;   // empty without additions
  std::vector<std::uint64_t> likenesses_;
  std::vector<int> positions_;  // of the graph's nodes in what is reached
  std::function<std::uint64_t(NodeId)> likeness_ = [this](NodeId id) { return likenesses_[position(id)]; };
  std::vector<GroupClear> clears_;
  std::vector<char> isCleared_;  // stores
  std::unordered_map<NodeId, NodeId> partners_;
  // The layout.
  NodeHomes *homes_ = nullptr;
  std::vector<Unit> regions_;
  std::vector<std::size_t> regionOf_;               // of the nodes
  std::vector<std::vector<std::size_t>> families_;  // of regions
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
