#include "compiler/ir/sweep.h"

#include "random_graph.h"
#include "run_sweep.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

namespace tf::ir {
namespace {

using Structure = std::vector<std::vector<int>>;

// No result depends on two seeds of one colour.
bool isProper(const Structure &structure, const std::vector<int> &colours) {
  return std::ranges::all_of(structure, [&](const std::vector<int> &seeds) {
    std::set<int> seen;
    return std::ranges::all_of(seeds, [&](int seed) { return seen.insert(colours[static_cast<std::size_t>(seed)]).second; });
  });
}

int count(const std::vector<int> &colours) { return 1 + *std::ranges::max_element(colours); }

TEST(ColourSeeds, DiagonalNeedsOneColourTridiagonalThreeAndAFullRowAll) {
  constexpr int n = 150;  // more than a word of bits
  Structure diagonal, tridiagonal, full(1);
  for (int k = 0; k < n; ++k) {
    diagonal.push_back({k});
    tridiagonal.push_back({});
    for (int j = std::max(0, k - 1); j <= std::min(n - 1, k + 1); ++j)
      tridiagonal.back().push_back(j);
    full[0].push_back(k);
  }
  EXPECT_EQ(count(colourSeeds(diagonal, n)), 1);
  EXPECT_EQ(count(colourSeeds(tridiagonal, n)), 3);
  EXPECT_EQ(count(colourSeeds(full, n)), n);
}

TEST(ColourSeeds, AreProperForRandomStructures) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const int seeds = 1 + static_cast<int>(random() % 100);
    Structure structure(1 + random() % 100);
    for (auto &row : structure)
      for (int seed = 0; seed < seeds; ++seed)
        if (random() % 8 == 0)
          row.push_back(seed);
    EXPECT_TRUE(isProper(structure, colourSeeds(structure, seeds)));
  }
}

// Sums of `width` seeds, each sum times `factors` functions that no other has: so many seeds go through each chain of products.
std::vector<NodeId> sumsOfProducts(Graph &g, int rows, int width, int factors) {
  std::vector<NodeId> results;
  for (int r = 0; r < rows; ++r) {
    NodeId sum = g.constant(0);
    for (int k = 0; k < width; ++k)
      sum = g.add(sum, g.symbol(SymbolKind::Seed, (r + k) % rows));
    for (int k = 0; k < factors; ++k)
      sum = g.mul(sum, g.add(g.symbol(SymbolKind::Coordinate, r), g.constant(1 + k)));
    results.push_back(sum);
  }
  return results;
}

TEST(IsSweepSmaller, WhereManySeedsGoThroughTheSameOperations) {
  constexpr int n = 60;
  Graph g;
  const auto smaller = [&](int width, std::size_t few) {
    const std::vector<NodeId> results = sumsOfProducts(g, n, width, 30);
    return isSweepSmaller(g, results, n, few);
  };
  // 30 products in each row, once in a loop, or once for each seed; half of a row's nodes depend on no seed.
  EXPECT_TRUE(smaller(20, 1000));
  EXPECT_FALSE(smaller(2, 100));
  EXPECT_FALSE(smaller(1, 10));
  EXPECT_FALSE(smaller(20, 1200)) << "so few entries may be written out";
}

// The directional derivatives of a band of functions, J s, and the gradients Jᵀ s, as sweeps.
class SweepTest : public ::testing::Test {
protected:
  static constexpr int n = 20;
  Graph g;
  std::vector<NodeId> x, f;
  std::vector<double> at;

  SweepTest() {
    for (int k = 0; k < n; ++k) {
      x.push_back(g.symbol(SymbolKind::State, k));
      at.push_back(std::sin(1.0 + k));
    }
    for (int k = 0; k + 2 < n; ++k) {
      const auto i = static_cast<std::size_t>(k);
      f.push_back(g.mul(g.unary(Op::Exp, x[i]), g.add(x[i + 2], g.unary(Op::Sin, x[i]))));
    }
  }

  [[nodiscard]] double value(Symbol symbol) const { return at[static_cast<std::size_t>(symbol.index)]; }
  std::vector<NodeId> forward() {
    return forwardDerivative(g, f, [&](Symbol symbol) { return g.symbol(SymbolKind::Seed, symbol.index); });
  }
  std::vector<NodeId> reverse() {
    std::vector<NodeId> weights;
    for (std::size_t k = 0; k < f.size(); ++k)
      weights.push_back(g.symbol(SymbolKind::Seed, static_cast<int>(k)));
    return reverseDerivative(g, f, weights, x);
  }
  // Row k in group k % 3 − 1.
  [[nodiscard]] std::vector<MatrixRow> rows() const {
    std::vector<MatrixRow> rows;
    for (std::size_t k = 0; k < f.size(); ++k)
      rows.push_back({0, static_cast<int>(k) * n, static_cast<int>(k % 3) - 1});
    return rows;
  }

  void expectJacobian(const std::vector<NodeId> &results, int seeds, SweepOver over) {
    const Structure structure = seedStructure(g, results, seeds);
    std::size_t entries = 0;
    for (const std::vector<int> &row : structure)
      entries += row.size();
    EXPECT_EQ(entries, 2 * f.size());
    Function function{"f", {static_cast<int>(f.size()) * n}, 2, {}};
    addSweep(function, results, structure, seeds, over, rows());
    EXPECT_EQ(verify(function, g), "");
    EXPECT_LE(function.sweep->colours.size(), 3U);
    const std::vector<double> expected = evaluate(g, jacobian(g, f, x), [&](Symbol s) { return value(s); });
    for (const std::vector<std::uint8_t> &mask : {std::vector<std::uint8_t>{1, 1}, {0, 1}, {0, 0}}) {
      std::vector<std::vector<double>> outputs{std::vector<double>(expected.size(), -7)};
      testing::runSweep(function, g, [&](Symbol s) { return value(s); }, mask, outputs);
      for (std::size_t k = 0; k < expected.size(); ++k) {
        const int group = static_cast<int>(k / n % 3) - 1;
        const bool isSelected = group < 0 || mask[static_cast<std::size_t>(group)] != 0;
        EXPECT_DOUBLE_EQ(outputs[0][k], isSelected ? expected[k] : -7) << k;
      }
    }
  }
};

TEST_F(SweepTest, ColumnsGiveTheJacobian) { expectJacobian(forward(), n, SweepOver::Columns); }

TEST_F(SweepTest, RowsGiveTheJacobian) { expectJacobian(reverse(), static_cast<int>(f.size()), SweepOver::Rows); }

TEST_F(SweepTest, NumbersOfTheMatrix) {
  const std::vector<double> expected = evaluate(g, jacobian(g, f, x), [&](Symbol s) { return value(s); });
  const std::vector<double> actual = evaluateMatrix(g, forward(), n, [&](Symbol s) { return value(s); });
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_DOUBLE_EQ(actual[k], expected[k]);
}

TEST_F(SweepTest, FullColumnsAreOneRunEach) {
  NodeId sum = g.constant(0);
  for (const NodeId one : x)
    sum = g.add(sum, g.unary(Op::Sin, one));
  f.clear();
  for (int k = 0; k < n; ++k)
    f.push_back(g.binary(Op::Pow, sum, g.constant(k + 1)));
  const std::vector<NodeId> results = forward();
  Function function{"f", {n * n}, 0, {}};
  std::vector<MatrixRow> all;
  for (int k = 0; k < n; ++k)
    all.push_back({0, k * n, -1});
  addSweep(function, results, seedStructure(g, results, n), n, SweepOver::Columns, all);
  ASSERT_EQ(function.sweep->colours.size(), static_cast<std::size_t>(n));
  for (int k = 0; k < n; ++k)
    EXPECT_EQ(function.sweep->colours[static_cast<std::size_t>(k)].runs, (std::vector<Sweep::Run>{{0, n, 0, k, n, -1}}));
  EXPECT_TRUE(function.clears.empty());
}

TEST_F(SweepTest, VerifierFindsWhatIsOutOfRange) {
  const std::vector<NodeId> results = forward();
  Function function{"f", {static_cast<int>(f.size()) * n}, 2, {}};
  addSweep(function, results, seedStructure(g, results, n), n, SweepOver::Columns, rows());
  Function outside(function);
  outside.sweep->colours.at(0).runs.at(0).position = n * n;
  EXPECT_NE(verify(outside, g), "");
  Function noGroup(function);
  noGroup.sweep->results.at(3).group = 2;
  EXPECT_NE(verify(noGroup, g), "");
  Function seeded(function);
  seeded.stores.push_back({0, 0, results[0], -1});
  EXPECT_NE(verify(seeded, g), "") << "a store depends on a seed";
}

TEST_F(SweepTest, VerifierFindsProductsThatCannotBe) {
  std::vector<NodeId> results = forward();
  const auto count = static_cast<int>(results.size());
  std::vector<MatrixRow> all;
  for (int k = 0; k < count; ++k)
    all.push_back({0, k * n, -1});
  Function function{"f", {count * n, count * Sweep::directions}, 0, {}};
  addSweep(function, results, seedStructure(g, results, n), n, SweepOver::Columns, all);
  function.sweep->products = 1;
  EXPECT_EQ(verify(function, g), "");
  Function noBuffer(function);
  noBuffer.sweep->products = 2;
  EXPECT_EQ(verify(noBuffer, g), "f: out[2]: there is no such buffer of " + std::to_string(count * Sweep::directions) + " products");
  Function tooSmall(function);
  tooSmall.bufferSizes[1] -= 1;
  EXPECT_NE(verify(tooSmall, g), "");
  Function grouped(function);
  grouped.groups = 1;
  EXPECT_EQ(verify(grouped, g), "f: the mask selects groups and products");
  Function constant(function);
  constant.sweep->results[1].node = g.constant(0);
  EXPECT_EQ(verify(constant, g), "f: products with a result 1 that depends on no seed");
}

}  // namespace
}  // namespace tf::ir
