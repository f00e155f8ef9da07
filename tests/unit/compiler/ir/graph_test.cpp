#include "compiler/ir/graph.h"

#include "compiler/ir/operations.h"
#include "lang/base/trigonometry.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace tf::ir {
namespace {

class GraphTest : public ::testing::Test {
protected:
  Graph g;
  NodeId x = g.symbol(SymbolKind::Coordinate, 0);
  NodeId y = g.symbol(SymbolKind::Coordinate, 1);
  NodeId z = g.symbol(SymbolKind::State, 0);
  NodeId c(double value) { return g.constant(value); }
};

TEST_F(GraphTest, EqualExpressionsAreOneNode) {
  EXPECT_EQ(g.add(x, y), g.add(y, x));
  EXPECT_EQ(g.mul(x, y), g.mul(y, x));
  EXPECT_NE(g.sub(x, y), g.sub(y, x));
  EXPECT_NE(g.symbol(SymbolKind::Coordinate, 0), g.symbol(SymbolKind::Velocity, 0));
  const int size = g.size();
  EXPECT_EQ(g.unary(Op::Sin, g.add(x, y)), g.unary(Op::Sin, g.add(y, x)));
  EXPECT_EQ(g.size(), size + 1);
  EXPECT_EQ(verify(g), "");
}

TEST_F(GraphTest, NeutralAndAbsorbingElements) {
  EXPECT_EQ(g.add(x, c(0)), x);
  EXPECT_EQ(g.sub(x, c(0)), x);
  EXPECT_EQ(g.sub(c(0), x), g.neg(x));
  EXPECT_EQ(g.mul(c(1), x), x);
  EXPECT_EQ(g.mul(x, c(-1)), g.neg(x));
  EXPECT_EQ(g.mul(x, c(0)), c(0));
  EXPECT_EQ(g.div(c(0), x), c(0));
  EXPECT_EQ(g.div(x, c(1)), x);
  EXPECT_EQ(g.sub(x, x), c(0));
  EXPECT_EQ(g.add(x, x), g.mul(c(2), x));
  EXPECT_EQ(g.binary(Op::Pow, x, c(1)), x);
  EXPECT_EQ(g.binary(Op::Pow, x, c(2)), g.mul(x, x));
  EXPECT_EQ(g.binary(Op::Pow, x, c(0)), c(1));
  EXPECT_EQ(g.binary(Op::Min, x, x), x);
}

TEST_F(GraphTest, SignsMoveOutwards) {
  EXPECT_EQ(g.neg(g.neg(x)), x);
  EXPECT_EQ(g.add(x, g.neg(y)), g.sub(x, y));
  EXPECT_EQ(g.sub(x, g.neg(y)), g.add(x, y));
  EXPECT_EQ(g.mul(g.neg(x), g.neg(y)), g.mul(x, y));
  EXPECT_EQ(g.mul(g.neg(x), y), g.neg(g.mul(x, y)));
  EXPECT_EQ(g.div(x, g.neg(y)), g.neg(g.div(x, y)));
  EXPECT_EQ(g.neg(g.sub(x, y)), g.sub(y, x));
  EXPECT_EQ(g.unary(Op::Sin, g.neg(x)), g.neg(g.unary(Op::Sin, x)));
  EXPECT_EQ(g.unary(Op::Cos, g.neg(x)), g.unary(Op::Cos, x));
  EXPECT_EQ(g.add(x, g.mul(c(-3), y)), g.sub(x, g.mul(c(3), y)));
  EXPECT_EQ(g.add(x, c(-3)), g.sub(x, c(3)));
}

TEST_F(GraphTest, ConstantFactorsMerge) {
  EXPECT_EQ(g.mul(c(0.5), g.mul(z, g.mul(c(2), x))), g.mul(z, x));
  EXPECT_EQ(g.mul(c(3), g.mul(c(5), x)), g.mul(c(15), x));
  EXPECT_EQ(g.div(x, c(4)), g.mul(c(0.25), x));
  EXPECT_EQ(g.add(g.mul(c(0.5), x), x), g.mul(c(1.5), x));
  EXPECT_EQ(g.sub(g.mul(c(3), x), g.mul(c(5), x)), g.mul(c(-2), x));
  EXPECT_EQ(g.sub(x, g.mul(c(-3), x)), g.mul(c(4), x));
  EXPECT_TRUE(g.isConstant(g.add(x, g.mul(c(-1), x)), 0));
  EXPECT_EQ(g[g.div(x, c(3))].op, Op::Div) << "1/3 is not exact";
}

TEST_F(GraphTest, ConstantsFoldButNeverToNanOrInfinity) {
  EXPECT_TRUE(g.isConstant(g.add(c(2), c(3)), 5));
  EXPECT_TRUE(g.isConstant(g.unary(Op::Sqrt, c(2)), std::sqrt(2.0)));
  EXPECT_EQ(g[g.div(c(1), c(0))].op, Op::Div);
  EXPECT_EQ(g[g.div(c(0), c(0))].op, Op::Div);
  EXPECT_EQ(g[g.unary(Op::Sqrt, c(-1))].op, Op::Sqrt);
  EXPECT_EQ(g[g.unary(Op::Log, c(0))].op, Op::Log);
  EXPECT_EQ(g[g.mul(c(1e200), c(1e200))].op, Op::Mul);
}

TEST_F(GraphTest, Choices) {
  const NodeId less = g.binary(Op::Less, x, y);
  EXPECT_EQ(g.ternary(Op::IfElse, less, z, z), z);
  EXPECT_EQ(g.ternary(Op::IfElse, c(1), x, y), x);
  EXPECT_EQ(g.ternary(Op::IfElse, c(0), x, y), y);
  EXPECT_EQ(g.ternary(Op::IfElse, g.unary(Op::Not, less), x, y), g.ternary(Op::IfElse, less, y, x));
  EXPECT_EQ(g.select(c(1), x, y), x);
  EXPECT_EQ(g.select(c(0), x, y), y);
  EXPECT_EQ(g[g.select(c(0.5), x, y)].op, Op::Select);
  EXPECT_EQ(g.binary(Op::And, c(1), less), less);
  EXPECT_TRUE(g.isConstant(g.binary(Op::And, less, c(0)), 0));
  EXPECT_TRUE(g.isConstant(g.binary(Op::Or, less, c(1)), 1));
  EXPECT_EQ(g.binary(Op::Or, less, less), less);
  EXPECT_EQ(g.unary(Op::Not, g.unary(Op::Not, less)), less);
  EXPECT_TRUE(g.isConstant(g.binary(Op::Less, x, x), 0));
}

TEST_F(GraphTest, SelectIgnoresTheOtherBranch) {
  const NodeId alpha = g.symbol(SymbolKind::StepVariable, 0);
  const NodeId root = g.select(alpha, x, g.unary(Op::Sqrt, y));
  const auto value = [&](double a) {
    return evaluate(g, std::array{root}, [&](Symbol s) { return s.kind == SymbolKind::StepVariable ? a : s.index == 0 ? 3.0 : -1.0; })[0];
  };
  EXPECT_EQ(value(1), 3);
  EXPECT_TRUE(std::isnan(value(0)));
  EXPECT_TRUE(std::isnan(value(0.5)));
}

TEST_F(GraphTest, SumIsBalanced) {
  std::vector<NodeId> terms;
  for (int k = 0; k < 64; ++k)
    terms.push_back(g.symbol(SymbolKind::Parameter, k));
  NodeId node = g.sum(terms);
  int depth = 0;
  while (g[node].arity > 0) {
    node = g[node].operands[0];
    ++depth;
  }
  EXPECT_EQ(depth, 6);
  EXPECT_TRUE(g.isConstant(g.sum({}), 0));
}

TEST_F(GraphTest, SubstitutionSimplifies) {
  const NodeId root = g.add(g.mul(x, y), g.unary(Op::Sin, x));
  const auto images = substitute(g, std::array{root}, [&](Symbol s) { return s.index == 0 ? c(0) : -1; });
  EXPECT_TRUE(g.isConstant(images[0], 0));
  EXPECT_EQ(substitute(g, std::array{root}, [](Symbol) { return -1; })[0], root);
}

TEST_F(GraphTest, DependenciesAreSortedAndUnique) {
  const std::array roots{g.mul(g.add(z, y), g.add(x, y)), c(1)};
  const auto symbols = dependencies(g, roots);
  const std::vector<Symbol> expected{{SymbolKind::Coordinate, 0}, {SymbolKind::Coordinate, 1}, {SymbolKind::State, 0}};
  EXPECT_EQ(symbols[0], expected);
  EXPECT_TRUE(symbols[1].empty());
  EXPECT_TRUE(dependsOn(g, roots[0], [](Symbol s) { return s.kind == SymbolKind::State; }));
  EXPECT_FALSE(dependsOn(g, roots[0], [](Symbol s) { return s.kind == SymbolKind::Velocity; }));
}

TEST_F(GraphTest, IntegerPowersAreProducts) {
  for (int n = -6; n <= 9; ++n)
    EXPECT_DOUBLE_EQ(integerPower(1.7, n), std::pow(1.7, n)) << n;
  EXPECT_EQ(integerPower(-2, 3), -8);
  EXPECT_EQ(multipliedExponent(g, c(3)), 3);
  EXPECT_FALSE(multipliedExponent(g, c(2.5)).has_value());
  EXPECT_FALSE(multipliedExponent(g, c(1e300)).has_value());
  EXPECT_FALSE(multipliedExponent(g, x).has_value());
}

// A chain of 200 000 operations goes through every pass without recursion.
TEST_F(GraphTest, DeepChains) {
  NodeId node = x;
  for (int k = 0; k < 100000; ++k)
    node = g.add(g.unary(Op::Sin, node), y);
  const std::array root{node};
  const std::array variables{x, y};
  const auto value = [](Symbol s) { return s.index == 0 ? 0.3 : 0.1; };
  double expected = 0.3;
  for (int k = 0; k < 100000; ++k)
    expected = sineAndCosine(expected).sine + 0.1;
  EXPECT_EQ(evaluate(g, root, value)[0], expected);
  const auto forward = forwardDerivative(g, root, [&](Symbol s) { return g.constant(s.index == 0 ? 1 : 0); });
  EXPECT_TRUE(std::isfinite(evaluate(g, forward, value)[0]));
  const auto gradient = reverseDerivative(g, root, std::array{g.constant(1)}, variables);
  EXPECT_TRUE(std::isfinite(evaluate(g, gradient, value)[1]));
  EXPECT_GT(print(g, node, [](Symbol) { return std::string("x"); }).size(), 100000U);
  EXPECT_EQ(substitute(g, root, [&](Symbol s) { return s.index == 0 ? y : -1; }).size(), 1U);
  EXPECT_EQ(verify(g), "");
  // The graph stays within a constant times the chain.
  EXPECT_LT(g.size(), 200000 * 8);
}

}  // namespace
}  // namespace tf::ir
