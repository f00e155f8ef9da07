#include "random_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ostream>

namespace tf::ir {
namespace {

double valueAt(const Graph &g, NodeId node, const std::vector<double> &states) {
  return evaluate(g, std::array{node}, [&](Symbol s) { return states[static_cast<std::size_t>(s.index)]; })[0];
}

// Central difference with Richardson extrapolation: error of order h^4.
double difference(const Graph &g, NodeId node, std::vector<double> states, std::size_t k) {
  const double x = states[k];
  const auto slope = [&](double h) {
    states[k] = x + h;
    const double upper = valueAt(g, node, states);
    states[k] = x - h;
    return (upper - valueAt(g, node, states)) / (2 * h);
  };
  return (4 * slope(1e-3) - slope(2e-3)) / 3;
}

struct DerivativeCase {
  const char *name;
  Op op;
  std::vector<double> at;
};

void PrintTo(const DerivativeCase &one, std::ostream *stream) { *stream << one.name; }

class EveryOperation : public ::testing::TestWithParam<DerivativeCase> {};

TEST_P(EveryOperation, MatchesFiniteDifferences) {
  const auto &[name, op, at] = GetParam();
  Graph g;
  std::vector<NodeId> x;
  for (std::size_t k = 0; k < at.size(); ++k)
    x.push_back(g.symbol(SymbolKind::State, static_cast<int>(k)));
  const NodeId node = x.size() == 1 ? g.unary(op, x[0]) : x.size() == 2 ? g.binary(op, x[0], x[1]) : g.ternary(op, x[0], x[1], x[2]);
  const auto gradient = reverseDerivative(g, std::array{node}, std::array{g.constant(1)}, x);
  for (std::size_t k = 0; k < at.size(); ++k) {
    const auto forward =
        forwardDerivative(g, std::array{node}, [&](Symbol s) { return g.constant(s.index == static_cast<int>(k) ? 1 : 0); });
    const double expected = op == Op::IfElse && k == 0 ? 0 : difference(g, node, at, k);
    EXPECT_NEAR(valueAt(g, forward[0], at), expected, 1e-9 * (1 + std::fabs(expected))) << name << " operand " << k;
    EXPECT_NEAR(valueAt(g, gradient[k], at), expected, 1e-9 * (1 + std::fabs(expected))) << name << " operand " << k << ", reverse";
  }
}

INSTANTIATE_TEST_SUITE_P(Derivative, EveryOperation,
                         ::testing::Values(DerivativeCase{"neg", Op::Neg, {0.7}}, DerivativeCase{"add", Op::Add, {0.7, 2}},
                                           DerivativeCase{"sub", Op::Sub, {0.7, 2}}, DerivativeCase{"mul", Op::Mul, {0.7, 2}},
                                           DerivativeCase{"div", Op::Div, {0.7, 2}}, DerivativeCase{"pow", Op::Pow, {0.7, 2.3}},
                                           DerivativeCase{"sqrt", Op::Sqrt, {0.7}}, DerivativeCase{"exp", Op::Exp, {0.7}},
                                           DerivativeCase{"log", Op::Log, {0.7}}, DerivativeCase{"log10", Op::Log10, {0.7}},
                                           DerivativeCase{"sin", Op::Sin, {0.7}}, DerivativeCase{"cos", Op::Cos, {0.7}},
                                           DerivativeCase{"tan", Op::Tan, {0.7}}, DerivativeCase{"asin", Op::Asin, {0.4}},
                                           DerivativeCase{"acos", Op::Acos, {0.4}}, DerivativeCase{"atan", Op::Atan, {0.7}},
                                           DerivativeCase{"atan2", Op::Atan2, {0.7, -1.1}}, DerivativeCase{"sinh", Op::Sinh, {0.7}},
                                           DerivativeCase{"cosh", Op::Cosh, {0.7}}, DerivativeCase{"tanh", Op::Tanh, {0.7}},
                                           DerivativeCase{"abs", Op::Abs, {-0.7}}, DerivativeCase{"sign", Op::Sign, {-0.7}},
                                           DerivativeCase{"min", Op::Min, {0.7, 0.2}}, DerivativeCase{"minLeft", Op::Min, {0.1, 0.2}},
                                           DerivativeCase{"max", Op::Max, {0.7, 0.2}}, DerivativeCase{"floor", Op::Floor, {0.7}},
                                           DerivativeCase{"ceil", Op::Ceil, {0.7}}, DerivativeCase{"less", Op::Less, {0.7, 0.2}},
                                           DerivativeCase{"ifTrue", Op::IfElse, {1, 0.7, 0.2}},
                                           DerivativeCase{"ifFalse", Op::IfElse, {0, 0.7, 0.2}},
                                           DerivativeCase{"select", Op::Select, {0.3, 0.7, 0.2}}),
                         [](const auto &test) { return std::string(test.param.name); });

TEST(Derivative, IntegerPowersOfNegativeBases) {
  Graph g;
  const NodeId x = g.symbol(SymbolKind::State, 0);
  for (int n = -4; n <= 7; ++n) {
    const NodeId node = g.binary(Op::Pow, x, g.constant(n));
    const auto d = forwardDerivative(g, std::array{node}, [&](Symbol) { return g.constant(1); });
    EXPECT_NEAR(valueAt(g, d[0], {-1.3}), n * std::pow(-1.3, n - 1), 1e-13 * std::fabs(n * std::pow(1.3, n - 1)) + 1e-15) << n;
  }
}

TEST(Derivative, SecondDerivativeOfAPendulumEnergy) {
  Graph g;
  const NodeId phi = g.symbol(SymbolKind::State, 0);
  const NodeId height = g.neg(g.mul(g.constant(9.81), g.unary(Op::Cos, phi)));
  const auto torque = reverseDerivative(g, std::array{height}, std::array{g.constant(1)}, std::array{phi});
  EXPECT_EQ(torque[0], g.mul(g.constant(9.81), g.unary(Op::Sin, phi)));
  const auto stiffness = jacobian(g, torque, std::array{phi});
  EXPECT_EQ(stiffness[0], g.mul(g.constant(9.81), g.unary(Op::Cos, phi)));
}

TEST(Derivative, MassTimesVelocityIsRecovered) {
  Graph g;
  const NodeId v = g.symbol(SymbolKind::Velocity, 0);
  const NodeId m = g.symbol(SymbolKind::Parameter, 0);
  const NodeId energy = g.mul(g.constant(0.5), g.mul(m, g.mul(v, v)));
  EXPECT_EQ(reverseDerivative(g, std::array{energy}, std::array{g.constant(1)}, std::array{v})[0], g.mul(m, v));
}

class RandomGraphs : public ::testing::TestWithParam<unsigned> {};

TEST_P(RandomGraphs, ForwardReverseAndJacobianAgree) {
  auto [g, variables, nodes] = testing::randomSmoothGraph(GetParam(), 6, 120);
  std::mt19937 random(GetParam() + 1000);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> states(variables.size());
  for (double &state : states)
    state = uniform(random);
  const std::vector<NodeId> tall(nodes.end() - 9, nodes.end());  // forward
  const std::vector<NodeId> wide(nodes.end() - 3, nodes.end());  // reverse
  const auto tallJacobian = jacobian(g, tall, variables);
  const auto wideJacobian = jacobian(g, wide, variables);
  const auto symbolDependencies = dependencies(g, tall);
  for (std::size_t j = 0; j < variables.size(); ++j) {
    const auto forward = forwardDerivative(g, tall, [&](Symbol s) { return g.constant(s.index == static_cast<int>(j) ? 1 : 0); });
    for (std::size_t i = 0; i < tall.size(); ++i) {
      const double expected = valueAt(g, forward[i], states);
      EXPECT_NEAR(valueAt(g, tallJacobian[i * 6 + j], states), expected, 1e-12 * (1 + std::fabs(expected)));
      const auto &symbols = symbolDependencies[i];
      if (std::find(symbols.begin(), symbols.end(), g[variables[j]].symbol) == symbols.end()) {
        EXPECT_TRUE(g.isConstant(tallJacobian[i * 6 + j], 0)) << "structural zero";
      }
      if (i >= 6) {
        EXPECT_NEAR(valueAt(g, wideJacobian[(i - 6) * 6 + j], states), expected, 1e-12 * (1 + std::fabs(expected)));
      }
    }
  }
  EXPECT_EQ(verify(g), "");
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomGraphs, ::testing::Range(0U, 40U));

TEST(Derivative, WeightedSumOfGradients) {
  Graph g;
  const NodeId x = g.symbol(SymbolKind::State, 0);
  const NodeId y = g.symbol(SymbolKind::State, 1);
  const NodeId force = g.mul(x, y);  // depends on the variables, but is a weight
  const auto gradient =
      reverseDerivative(g, std::array{g.mul(x, x), g.unary(Op::Sin, y)}, std::array{force, g.constant(2)}, std::array{x, y});
  EXPECT_DOUBLE_EQ(valueAt(g, gradient[0], {3, 0.5}), 3 * 0.5 * 2 * 3);
  EXPECT_DOUBLE_EQ(valueAt(g, gradient[1], {3, 0.5}), 2 * std::cos(0.5));
}

// The branch that is not taken has a derivative that is not finite; neither mode may see it.
TEST(Derivative, UntakenSingularBranchLeavesNoNan) {
  Graph g;
  const NodeId x = g.symbol(SymbolKind::State, 0);
  const NodeId y = g.symbol(SymbolKind::State, 1);
  const NodeId alpha = g.symbol(SymbolKind::State, 2);
  const NodeId root = g.unary(Op::Sqrt, x);
  const NodeId guarded = g.ternary(Op::IfElse, g.binary(Op::Less, g.constant(0), x), root, y);
  const NodeId selected = g.select(alpha, g.mul(root, y), y);
  for (const NodeId node : {g.mul(y, guarded), g.mul(y, selected), g.mul(g.constant(3), g.binary(Op::Max, y, g.div(y, x)))}) {
    const auto gradient = reverseDerivative(g, std::array{node}, std::array{g.constant(1)}, std::array{x, y});
    const auto forward = forwardDerivative(g, std::array{node}, [&](Symbol s) { return g.constant(s.index == 1 ? 1 : 0); });
    EXPECT_EQ(valueAt(g, gradient[0], {-0.0, 0.5, 0}), 0) << node;
    EXPECT_EQ(valueAt(g, gradient[1], {-0.0, 0.5, 0}), valueAt(g, forward[0], {-0.0, 0.5, 0})) << node;
    EXPECT_TRUE(std::isfinite(valueAt(g, gradient[1], {-0.0, 0.5, 0}))) << node;
  }
}

}  // namespace
}  // namespace tf::ir
