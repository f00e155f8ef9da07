#include "compiler/codegen/code_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace tf::codegen {
namespace {

using ir::NodeId;
using ir::Op;

class CodePlanTest : public ::testing::Test {
protected:
  ir::Graph g;
  NodeId x = g.symbol(ir::SymbolKind::State, 0);
  NodeId y = g.symbol(ir::SymbolKind::State, 1);

  static ir::Function function(int size, int groups, std::vector<ir::Store> stores) { return {"f", {size}, groups, std::move(stores)}; }

  // Group of the unit that evaluates the node; −2 if none does.
  static int groupOf(const CodePlan &plan, NodeId node) {
    for (const Unit &unit : plan.units)
      for (const Step &step : unit.steps)
        if (step.kind == Step::Kind::Evaluate && step.node == node)
          return unit.group;
    return -2;
  }
};

TEST_F(CodePlanTest, NodesOfOneGroupAreUnderItsGuardAndSharedOnesAreNot) {
  const NodeId onlyFirst = g.unary(Op::Exp, x);
  const NodeId shared = g.unary(Op::Sin, x);
  const NodeId unused = g.unary(Op::Tan, x);
  const NodeId first = g.add(onlyFirst, shared), second = g.mul(shared, y);
  const CodePlan plan = planCode(function(2, 2, {{0, 0, first, 0}, {0, 1, second, 1}}), g, 100);
  EXPECT_FALSE(plan.isSplit);
  EXPECT_EQ(groupOf(plan, onlyFirst), 0);
  EXPECT_EQ(groupOf(plan, first), 0);
  EXPECT_EQ(groupOf(plan, second), 1);
  EXPECT_EQ(groupOf(plan, shared), -1);
  EXPECT_EQ(groupOf(plan, unused), -2);
  EXPECT_EQ(groupOf(plan, x), -2) << "symbols are loaded where they are needed";
}

TEST_F(CodePlanTest, SineAndCosineOfOneArgumentAreNeighbours) {
  const NodeId sine = g.unary(Op::Sin, x), cosine = g.unary(Op::Cos, x);
  NodeId between = y;
  for (int k = 0; k < 5; ++k)
    between = g.add(g.unary(Op::Exp, between), y);
  const CodePlan plan = planCode(function(3, 0, {{0, 0, sine, -1}, {0, 1, between, -1}, {0, 2, cosine, -1}}), g, 100);
  ASSERT_GE(plan.units.front().steps.size(), 2U);
  EXPECT_EQ(plan.units.front().steps[0].node, sine);
  EXPECT_EQ(plan.units.front().steps[1].node, cosine);
}

TEST_F(CodePlanTest, ACosineFollowsItsSineOutOfAGroup) {
  const NodeId sine = g.unary(Op::Sin, x), cosine = g.unary(Op::Cos, x), alone = g.unary(Op::Cos, y);
  const CodePlan plan = planCode(function(3, 1, {{0, 0, sine, -1}, {0, 1, cosine, 0}, {0, 2, alone, 0}}), g, 100);
  EXPECT_EQ(groupOf(plan, sine), -1);
  EXPECT_EQ(groupOf(plan, cosine), -1);
  EXPECT_EQ(groupOf(plan, alone), 0);
}

TEST_F(CodePlanTest, ZerosAreClearedInRuns) {
  std::vector<ir::Store> stores;
  const NodeId zero = g.constant(0);
  for (int k = 0; k < 1000; ++k)
    stores.push_back({0, k, k == 3 || k == 500 ? x : zero, -1});
  const CodePlan plan = planCode(function(1000, 0, stores), g, 100);
  ASSERT_EQ(plan.units.size(), 1U);
  std::map<int, int> cleared;
  std::set<int> stored;
  for (const Step &step : plan.units.front().steps) {
    if (step.kind == Step::Kind::Clear) {
      EXPECT_TRUE(stored.empty()) << "clearing comes first";
      cleared[step.position] = step.length;
    } else {
      stored.insert(step.position);
    }
  }
  EXPECT_EQ(cleared, (std::map<int, int>{{0, 1000}}));
  EXPECT_EQ(stored, (std::set<int>{3, 500}));
}

TEST_F(CodePlanTest, ClearingDoesNotReachIntoOtherGroups) {
  std::vector<ir::Store> stores;
  for (int k = 0; k < 40; ++k)
    stores.push_back({0, k, g.constant(0), k < 20 ? 0 : 1});
  const CodePlan plan = planCode(function(40, 2, stores), g, 100);
  ASSERT_EQ(plan.units.size(), 2U);
  for (const Unit &unit : plan.units) {
    ASSERT_EQ(unit.steps.size(), 1U);
    EXPECT_EQ(unit.steps[0].position, unit.group == 0 ? 0 : 20);
    EXPECT_EQ(unit.steps[0].length, 20);
  }
}

// Interprets the slots of a split plan: no unit reads a slot that another value has taken since, or writes one that it reads.
TEST_F(CodePlanTest, ValuesSurviveInTheirSlots) {
  std::vector<NodeId> nodes{x, y};
  for (std::size_t k = 0; k < 400; ++k)
    nodes.push_back(g.add(g.unary(Op::Sin, nodes[k * 7 % nodes.size()]), nodes[k * 13 % nodes.size()]));
  std::vector<ir::Store> stores;
  for (int k = 0; k < 60; ++k)
    stores.push_back({0, k, nodes[nodes.size() - 1 - static_cast<std::size_t>(k) * 6], k % 3 - 1});
  const CodePlan plan = planCode(function(60, 2, stores), g, 50);
  ASSERT_TRUE(plan.isSplit);
  EXPECT_LT(plan.slotCount, static_cast<int>(plan.slotNodes.size())) << "slots are used again";
  std::map<int, NodeId> slots;
  for (const Unit &unit : plan.units) {
    EXPECT_LE(unit.steps.size(), 50U);
    std::set<NodeId> here;
    std::set<int> read, written;
    for (const Step &step : unit.steps) {
      std::vector<NodeId> uses;
      if (step.kind == Step::Kind::Evaluate)
        uses.assign(g[step.node].operands, g[step.node].operands + g[step.node].arity);
      else
        uses = {step.node};
      for (const NodeId use : uses)
        if (g[use].arity > 0 && !here.contains(use)) {
          EXPECT_EQ(slots.at(plan.slotOf(use).index), use);
          read.insert(plan.slotOf(use).index);
        }
      if (step.kind != Step::Kind::Evaluate)
        continue;
      here.insert(step.node);
      if (const int slot = plan.slotOf(step.node).index; slot >= 0) {
        slots[slot] = step.node;
        written.insert(slot);
      }
    }
    for (const int slot : written)
      EXPECT_FALSE(read.contains(slot)) << slot;
  }
}

// The loop of a sweep holds what depends on seeds, and nothing that it reads from outside loses its slot before the loop's end.
TEST_F(CodePlanTest, SweepsAreLoops) {
  const NodeId seed = g.symbol(ir::SymbolKind::Seed, 0);
  std::vector<NodeId> outside{x, y}, inside{seed};
  for (std::size_t k = 0; k < 200; ++k) {
    outside.push_back(g.add(g.unary(Op::Sin, outside[k]), outside[k * 13 % outside.size()]));
    inside.push_back(g.add(g.mul(outside.back(), inside[k]), g.mul(outside[k], inside[k * 7 % inside.size()])));
  }
  ir::Function sweeping = function(1, 2, {{0, 0, outside.back(), -1}});
  sweeping.sweep.emplace();
  sweeping.sweep->seedCount = 1;
  sweeping.sweep->results = {{inside.back(), -1}, {inside[120], 1}, {outside[50], 0}};
  const CodePlan plan = planCode(sweeping, g, 30);
  ASSERT_TRUE(plan.isSplit);
  bool isInLoop = false;
  std::map<int, NodeId> slots, rows;
  std::set<int> readInLoop;
  for (const Unit &unit : plan.units) {
    EXPECT_LE(isInLoop, unit.isSwept) << "the loop comes last";
    isInLoop = unit.isSwept;
    std::set<NodeId> here;
    for (const Step &step : unit.steps) {
      std::vector<NodeId> uses;
      if (step.kind == Step::Kind::Evaluate)
        uses.assign(g[step.node].operands, g[step.node].operands + g[step.node].arity);
      else
        uses = {step.node};
      for (const NodeId use : uses)
        if (g[use].arity > 0 && !here.contains(use)) {
          const Slot slot = plan.slotOf(use);
          EXPECT_EQ((slot.isSwept ? rows : slots).at(slot.index), use);
          if (unit.isSwept && !slot.isSwept)
            readInLoop.insert(slot.index);
        }
      if (step.kind != Step::Kind::Evaluate)
        continue;
      here.insert(step.node);
      EXPECT_EQ(unit.isSwept, std::ranges::count(outside, step.node) == 0 && g[step.node].op != Op::Sin);
      if (const Slot slot = plan.slotOf(step.node); slot.index >= 0) {
        EXPECT_EQ(slot.isSwept, unit.isSwept);
        EXPECT_FALSE(!slot.isSwept && readInLoop.contains(slot.index)) << "the next turn of the loop reads it again";
        (slot.isSwept ? rows : slots)[slot.index] = step.node;
      }
    }
  }
  EXPECT_TRUE(isInLoop);
}

// Units of the same steps at other places, with other constants; what two groups have in common is under a guard of both.
TEST_F(CodePlanTest, GroupsThatAreAlikeAreRepeated) {
  std::vector<ir::Store> stores;
  std::map<NodeId, int> pairOf;
  for (int k = 0; k < 30; ++k) {
    NodeId shared = g.add(g.mul(x, g.constant(k + 2)), y);
    for (int n = 0; n < 5; ++n)
      shared = g.unary(Op::Exp, shared);
    pairOf[shared] = k;
    stores.push_back({0, 2 * k, g.unary(Op::Sqrt, shared), 2 * k});
    stores.push_back({0, 2 * k + 1, g.mul(shared, y), 2 * k + 1});
  }
  const CodePlan plan = planCode(function(60, 60, stores), g, 100);
  ASSERT_TRUE(plan.isSplit);
  std::map<NodeId, const Unit *> unitOf;
  for (const Unit &unit : plan.units)
    for (const Step &step : unit.steps) {
      if (step.kind != Step::Kind::Evaluate)
        continue;
      EXPECT_TRUE(unitOf.emplace(step.node, &unit).second) << "a node is in one unit";
    }
  for (const auto &[shared, k] : pairOf) {
    EXPECT_EQ(unitOf.at(shared)->group, 2 * k);
    EXPECT_EQ(unitOf.at(shared)->second, 2 * k + 1);
    EXPECT_GE(plan.slotOf(shared).index, 0);
  }
  ASSERT_FALSE(plan.repetitions.empty());
  EXPECT_EQ(plan.repetitions.front().first, 0) << "what groups have in common comes first";
  EXPECT_EQ(plan.repetitions.front().count, 30);
  int end = 0;
  for (const Repetition &repetition : plan.repetitions) {
    EXPECT_GE(repetition.first, end);
    end = repetition.first + repetition.count;
    for (int u = repetition.first; u < end; ++u)
      EXPECT_EQ(plan.units[static_cast<std::size_t>(u)].steps.size(), plan.units[static_cast<std::size_t>(repetition.first)].steps.size());
  }
}

// A node that three groups need, or one and what is stored always, has no guard.
TEST_F(CodePlanTest, WhatManyNeedHasNoGuard) {
  std::vector<ir::Store> stores;
  const NodeId common = g.unary(Op::Tan, x);
  for (int k = 0; k < 60; ++k)
    stores.push_back({0, k, g.unary(Op::Exp, g.unary(Op::Exp, g.mul(common, g.constant(k + 2)))), k});
  const CodePlan plan = planCode(function(60, 60, stores), g, 100);
  ASSERT_TRUE(plan.isSplit);
  EXPECT_EQ(groupOf(plan, common), -1);
  EXPECT_EQ(plan.units.front().steps.front().node, common);
}

}  // namespace
}  // namespace tf::codegen
