#include "compiler/ir/deviation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ostream>
#include <random>
#include <string>
#include <vector>

namespace tf::ir {
namespace {

// Coordinates deviate by the symbols Radius, states by nothing.
NodeId boundOf(Graph &g, NodeId root) {
  return deviationBounds(g, std::array{root}, [&g](Symbol symbol) {
    return symbol.kind == SymbolKind::Coordinate ? g.symbol(SymbolKind::Radius, symbol.index) : g.constant(0);
  })[0];
}

double valueAt(const Graph &g, NodeId node, const std::vector<double> &x, const std::vector<double> &radius) {
  return evaluate(g, std::array{node}, [&](Symbol symbol) {
    const auto k = static_cast<std::size_t>(symbol.index);
    return symbol.kind == SymbolKind::Radius ? radius[k] : x[k];
  })[0];
}

struct DeviationCase {
  const char *name;
  std::function<NodeId(Graph &, NodeId, NodeId)> make;
};

void PrintTo(const DeviationCase &one, std::ostream *stream) { *stream << one.name; }

class Deviations : public ::testing::TestWithParam<DeviationCase> {};

// Arguments are positive and as far from zero as the box is wide, now and then less.
TEST_P(Deviations, BoundsHoldAllOverTheBox) {
  Graph g;
  const NodeId x = g.symbol(SymbolKind::Coordinate, 0), y = g.symbol(SymbolKind::Coordinate, 1);
  const NodeId root = GetParam().make(g, x, y), bound = boundOf(g, root);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> center(0.1, 3), width(0, 0.5), side(-1, 1);
  double tightest = 0;
  for (int run = 0; run < 400; ++run) {
    const std::vector<double> at = {center(generator), center(generator)}, radius = {width(generator), width(generator)};
    const double value = valueAt(g, root, at, radius), most = valueAt(g, bound, at, radius);
    for (int sample = 0; sample < 60; ++sample) {
      std::vector<double> near = at;
      for (std::size_t k = 0; k < near.size(); ++k)
        near[k] += radius[k] * (sample < 4 ? ((sample >> k) % 2 == 0 ? 1.0 : -1.0) : side(generator));
      const double change = std::abs(valueAt(g, root, near, radius) - value);
      if (std::isfinite(change) && std::isfinite(most)) {
        EXPECT_LE(change, most * (1 + 1e-12) + 1e-14) << at[0] << " " << at[1] << " ± " << radius[0] << " " << radius[1];
        tightest = std::max(tightest, change / most);
      }
    }
  }
  EXPECT_GT(tightest, 0.2);
}

NodeId constant(Graph &g, double value) { return g.constant(value); }

INSTANTIATE_TEST_SUITE_P(
    Operations, Deviations,
    ::testing::Values(
        DeviationCase{"sum", [](Graph &g, NodeId x, NodeId y) { return g.sub(g.add(x, constant(g, 2)), g.neg(y)); }},
        DeviationCase{"product", [](Graph &g, NodeId x, NodeId y) { return g.mul(x, y); }},
        DeviationCase{"square", [](Graph &g, NodeId x, NodeId) { return g.mul(x, x); }},
        DeviationCase{"quotient", [](Graph &g, NodeId x, NodeId y) { return g.div(x, y); }},
        DeviationCase{"power", [](Graph &g, NodeId x, NodeId) { return g.binary(Op::Pow, x, constant(g, 2.5)); }},
        DeviationCase{"smallPower", [](Graph &g, NodeId x, NodeId) { return g.binary(Op::Pow, x, constant(g, 0.3)); }},
        DeviationCase{"root", [](Graph &g, NodeId x, NodeId) { return g.unary(Op::Sqrt, x); }},
        DeviationCase{"exponential", [](Graph &g, NodeId x, NodeId) { return g.unary(Op::Exp, x); }},
        DeviationCase{"logarithm", [](Graph &g, NodeId x, NodeId) { return g.unary(Op::Log, x); }},
        DeviationCase{"decimal", [](Graph &g, NodeId x, NodeId) { return g.unary(Op::Log10, x); }},
        DeviationCase{"sine", [](Graph &g, NodeId x, NodeId) { return g.unary(Op::Sin, g.mul(constant(g, 9), x)); }},
        DeviationCase{"cosine", [](Graph &g, NodeId x, NodeId y) { return g.mul(y, g.unary(Op::Cos, x)); }},
        DeviationCase{"arc", [](Graph &g, NodeId x, NodeId) { return g.unary(Op::Atan, x); }},
        DeviationCase{"tanh", [](Graph &g, NodeId x, NodeId) { return g.unary(Op::Tanh, x); }},
        DeviationCase{"absolute", [](Graph &g, NodeId x, NodeId y) { return g.unary(Op::Abs, g.sub(x, y)); }},
        DeviationCase{"sign", [](Graph &g, NodeId x, NodeId y) { return g.unary(Op::Sign, g.sub(x, y)); }},
        DeviationCase{"floor", [](Graph &g, NodeId x, NodeId) { return g.unary(Op::Floor, x); }},
        DeviationCase{"least", [](Graph &g, NodeId x, NodeId y) { return g.binary(Op::Min, x, y); }},
        DeviationCase{"greatest", [](Graph &g, NodeId x, NodeId y) { return g.binary(Op::Max, x, g.mul(y, y)); }},
        DeviationCase{"choice",
                      [](Graph &g, NodeId x, NodeId y) { return g.ternary(Op::IfElse, g.binary(Op::Less, x, y), g.mul(y, y), x); }},
        DeviationCase{
            "distance",
            [](Graph &g, NodeId x,
               NodeId y) { return g.unary(Op::Sqrt, g.add(g.mul(g.sub(x, constant(g, 5)), g.sub(x, constant(g, 5))), g.mul(y, y))); }}),
    [](const ::testing::TestParamInfo<DeviationCase> &tested) { return std::string(tested.param.name); });

TEST(Deviation, WhatDoesNotMoveHasNone) {
  Graph g;
  const NodeId z = g.symbol(SymbolKind::State, 0);
  EXPECT_TRUE(g.isConstant(boundOf(g, g.unary(Op::Tan, z)), 0));
  EXPECT_TRUE(g.isConstant(boundOf(g, g.constant(3)), 0));
}

TEST(Deviation, WithoutABoundItIsInfinite) {
  Graph g;
  const NodeId x = g.symbol(SymbolKind::Coordinate, 0);
  EXPECT_FALSE(std::isfinite(valueAt(g, boundOf(g, g.unary(Op::Tan, x)), {1, 0}, {0.1, 0})));
  // The divisor may be zero, and so may the argument of the logarithm.
  EXPECT_FALSE(std::isfinite(valueAt(g, boundOf(g, g.div(g.constant(1), x)), {1, 0}, {1.5, 0})));
  EXPECT_FALSE(std::isfinite(valueAt(g, boundOf(g, g.unary(Op::Log, x)), {1, 0}, {1.5, 0})));
}

// Where the function itself is none.
TEST(Deviation, RootsOfNegativeNumbers) {
  Graph g;
  const NodeId x = g.symbol(SymbolKind::Coordinate, 0);
  EXPECT_FALSE(std::isfinite(valueAt(g, boundOf(g, g.unary(Op::Sqrt, x)), {1, 0}, {1.5, 0})));
  EXPECT_FALSE(std::isfinite(valueAt(g, boundOf(g, g.binary(Op::Pow, x, g.constant(0.5))), {1, 0}, {1.5, 0})));
  EXPECT_TRUE(std::isfinite(valueAt(g, boundOf(g, g.unary(Op::Sqrt, g.mul(x, x))), {1, 0}, {1.5, 0})));
}

// A step variable may take any value between 0 and 1.
TEST(Deviation, StepVariablesChangeOver) {
  Graph g;
  const NodeId alpha = g.symbol(SymbolKind::StepVariable, 0), x = g.symbol(SymbolKind::Coordinate, 0);
  const NodeId bound = deviationBounds(g, std::array{g.select(alpha, x, g.constant(5))}, [&g](Symbol symbol) {
    return symbol.kind == SymbolKind::StepVariable ? g.constant(1) : g.symbol(SymbolKind::Radius, symbol.index);
  })[0];
  EXPECT_DOUBLE_EQ(valueAt(g, bound, {2}, {0.25}), 3.25);
}

}  // namespace
}  // namespace tf::ir
