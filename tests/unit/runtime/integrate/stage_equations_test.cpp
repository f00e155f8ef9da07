#include "runtime/integrate/stage_equations.h"

#include "runtime/integrate/collocation.h"

#include <gtest/gtest.h>

#include <random>

namespace tf::runtime {
namespace {

std::vector<double> radauCoefficients(int stages) { return collocationCoefficients(radauNodes(stages)); }

// The residual of the equations, all stages of all variables in one matrix.
double residualOf(const std::vector<Eigen::MatrixXd> &jacobians, double h) {
  const auto stages = static_cast<int>(jacobians.size()), n = static_cast<int>(jacobians.front().rows());
  const std::vector<double> a = radauCoefficients(stages);
  StageEquations equations(n, a);
  Eigen::MatrixXd whole = Eigen::MatrixXd::Identity(n * stages, n * stages);
  for (int j = 0; j < stages; ++j) {
    equations.jacobian(j) = jacobians[static_cast<std::size_t>(j)];
    for (int i = 0; i < stages; ++i)
      whole.block(i * n, j * n, n, n) -= h * a[static_cast<std::size_t>(i) * stages + j] * jacobians[static_cast<std::size_t>(j)];
  }
  equations.factorise(h);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(n * stages, -1, 2);
  Eigen::VectorXd solution = right;
  equations.solve(solution);
  return (whole * solution - right).lpNorm<Eigen::Infinity>() / std::max(1.0, solution.lpNorm<Eigen::Infinity>());
}

class RandomEntries {
public:
  explicit RandomEntries(unsigned seed) : engine_(seed) {}
  double operator()() { return value_(engine_); }
  bool happens(double probability) { return std::uniform_real_distribution<double>(0, 1)(engine_) < probability; }

private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> value_{-1, 1};
};

TEST(StageEquationsTest, DenseJacobiansOfEachStage) {
  RandomEntries random(1);
  for (int stages = 1; stages <= 4; ++stages) {
    std::vector<Eigen::MatrixXd> jacobians;
    jacobians.reserve(stages);
    for (int j = 0; j < stages; ++j)
      jacobians.emplace_back(Eigen::MatrixXd::NullaryExpr(5, 5, [&] { return random(); }));
    EXPECT_LT(residualOf(jacobians, 0.3), 1e-13);
  }
}

TEST(StageEquationsTest, SparseJacobiansWhosePatternsDifferBetweenStages) {
  RandomEntries random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const int stages = 1 + trial % 4, n = 1 + trial % 90;
    const double density = (trial % 7 + 1) / (2.0 * n);
    std::vector<Eigen::MatrixXd> jacobians;
    jacobians.reserve(stages);
    for (int j = 0; j < stages; ++j)
      jacobians.emplace_back(Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.happens(density) ? random() : 0.0; }));
    EXPECT_LT(residualOf(jacobians, 0.4), 1e-11) << "trial " << trial;
  }
}

// Stiff bodies of q' = v, v' = −1e6 q − 1e3 v, pairs of which push each other, and others that only move on.
TEST(StageEquationsTest, CoordinatesOfBodiesThatPushEachOther) {
  constexpr int bodies = 9, n = 2 * bodies;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < bodies; ++k) {
    jacobian(k, bodies + k) = 1;
    if (k % 3 == 2)
      continue;
    const int other = k % 3 == 0 ? k + 1 : k - 1;
    jacobian(bodies + k, k) = -1e6;
    jacobian(bodies + k, other) = 1e6;
    jacobian(bodies + k, bodies + k) = -1e3;
  }
  EXPECT_LT(residualOf({jacobian, jacobian, jacobian, jacobian}, 0.01), 1e-10);
}

TEST(StageEquationsTest, EarlierJacobiansAreForgotten) {
  StageEquations equations(2, {1.0});
  for (const double entry : {3.0, 0.0}) {
    equations.jacobian(0) << 0, 1, entry, 0;
    equations.factorise(1);
    Eigen::VectorXd solution = Eigen::Vector2d(1, 2);
    equations.solve(solution);
    // x − y = 1, y − entry x = 2
    EXPECT_NEAR(solution[0], 3 / (1 - entry), 1e-14);
    EXPECT_NEAR(solution[1], (2 + entry) / (1 - entry), 1e-14);
  }
}

}  // namespace
}  // namespace tf::runtime
