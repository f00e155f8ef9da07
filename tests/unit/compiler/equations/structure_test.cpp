#include "compiler/equations/structure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace tf::equations {
namespace {

TEST(Matching, FindsAnAugmentingPath) {
  // Greedy choice of variable 0 for equation 0 must be revised for equation 1.
  Matching matching(2, 2);
  matching.addEdge(0, 0);
  matching.addEdge(0, 1);
  matching.addEdge(1, 0);
  EXPECT_EQ(matching.augmentAll(), 0);
  EXPECT_EQ(matching.variableOf(0), 1);
  EXPECT_EQ(matching.variableOf(1), 0);
  EXPECT_EQ(matching.equationOf(0), 1);
}

TEST(Matching, LeavesWhatCannotBeMatchedFree) {
  Matching matching(3, 3);
  for (int equation = 0; equation < 3; ++equation)
    matching.addEdge(equation, 1);
  EXPECT_EQ(matching.augmentAll(), 2);
  EXPECT_EQ(matching.equationOf(0), -1);
  EXPECT_EQ(matching.equationOf(2), -1);
  EXPECT_GE(matching.equationOf(1), 0);
}

TEST(Matching, GrowsWithLaterEdges) {
  Matching matching(2, 2);
  EXPECT_TRUE(matching.join(0, 0));
  EXPECT_FALSE(matching.join(1, 0));
  matching.addEdge(1, 0);
  EXPECT_EQ(matching.augmentAll(), 1);
  matching.addEdge(0, 1);
  EXPECT_EQ(matching.augmentAll(), 0);
  EXPECT_EQ(matching.variableOf(0), 1);
}

// A path through all equations: long augmenting paths must not exhaust the stack.
TEST(Matching, LongPath) {
  const int n = 100000;
  Matching matching(n, n);
  for (int k = 0; k + 1 < n; ++k) {
    matching.addEdge(k, k);
    matching.addEdge(k, k + 1);
    (void)matching.join(k, k);
  }
  matching.addEdge(n - 1, 0);
  EXPECT_EQ(matching.augmentAll(), 0);
  EXPECT_EQ(matching.variableOf(0), 1);
  EXPECT_EQ(matching.variableOf(n - 1), 0);
}

// Against the maximum found by trying all assignments.
TEST(Matching, IsMaximum) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    const int n = 6;
    std::vector<std::vector<int>> edges(n);
    Matching matching(n, n);
    for (int equation = 0; equation < n; ++equation)
      for (int variable = 0; variable < n; ++variable)
        if (random() % 4 == 0) {
          edges[static_cast<std::size_t>(equation)].push_back(variable);
          matching.addEdge(equation, variable);
        }
    std::vector<int> order(n);
    std::iota(order.begin(), order.end(), 0);
    int best = 0;
    do {
      int matched = 0;
      for (int equation = 0; equation < n; ++equation)
        matched +=
            static_cast<int>(std::ranges::count(edges[static_cast<std::size_t>(equation)], order[static_cast<std::size_t>(equation)]));
      best = std::max(best, matched);
    } while (std::ranges::next_permutation(order).found);
    EXPECT_EQ(n - matching.augmentAll(), best);
  }
}

TEST(Components, OrderOfEvaluation) {
  // 0 needs 2, 2 needs 1: evaluated 1, 2, 0.
  EXPECT_THAT(stronglyConnectedComponents({{2}, {}, {1}}), ::testing::ElementsAre(std::vector{1}, std::vector{2}, std::vector{0}));
}

TEST(Components, Loops) {
  const auto components = stronglyConnectedComponents({{1}, {2, 3}, {0}, {4}, {3}, {5}});
  ASSERT_EQ(components.size(), 3U);
  EXPECT_THAT(components[0], ::testing::UnorderedElementsAre(3, 4));
  EXPECT_THAT(components[1], ::testing::UnorderedElementsAre(0, 1, 2));
  EXPECT_THAT(components[2], ::testing::ElementsAre(5));
}

TEST(Components, LongChain) {
  const int n = 200000;
  std::vector<std::vector<int>> successors(n);
  for (int k = 0; k + 1 < n; ++k)
    successors[static_cast<std::size_t>(k)] = {k + 1};
  const auto components = stronglyConnectedComponents(successors);
  ASSERT_EQ(components.size(), static_cast<std::size_t>(n));
  EXPECT_EQ(components.front()[0], n - 1);
  EXPECT_EQ(components.back()[0], 0);
}

}  // namespace
}  // namespace tf::equations
