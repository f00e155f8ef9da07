#include "runtime/integrate/mass_matrix.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>

namespace tf::runtime {
namespace {

TEST(MassMatrix, SolvesDenseSystems) {
  constexpr int n = 7;
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(n, n);
  const Eigen::MatrixXd mass = root * root.transpose() + Eigen::MatrixXd::Identity(n, n);
  const Eigen::VectorXd right = Eigen::VectorXd::Random(n);
  MassMatrix factor(n);
  ASSERT_TRUE(factor.factorise(mass.data()));
  Eigen::VectorXd solution = right;
  factor.solve(solution.data(), solution.data());
  EXPECT_LT((mass * solution - right).norm(), 1e-12);
}

TEST(MassMatrix, SolvesDiagonalSystems) {
  const double mass[] = {2, 0, 0, 4};
  const double right[] = {1, 1};
  double solution[2];
  MassMatrix factor(2);
  ASSERT_TRUE(factor.factorise(mass));
  factor.solve(right, solution);
  EXPECT_EQ(solution[0], 0.5);
  EXPECT_EQ(solution[1], 0.25);
}

TEST(MassMatrix, NamesTheRowWithoutInertia) {
  const double singular[] = {1, 1, 1, 1};
  MassMatrix factor(2);
  EXPECT_FALSE(factor.factorise(singular));
  EXPECT_EQ(factor.failedRow(), 1);
  const double massless[] = {0, 0, 0, 1};
  EXPECT_FALSE(factor.factorise(massless));
  EXPECT_EQ(factor.failedRow(), 0);
}

// Masses between springs of inertia (tridiagonal), a cart with pendulums (first row full) in both orders, bodies apart, trees.
TEST(MassMatrix, SolvesWithinEnvelopes) {
  constexpr int n = 30;
  for (int kind = 0; kind < 5; ++kind) {
    Eigen::MatrixXd mass = 10 * Eigen::MatrixXd::Identity(n, n);
    const auto couple = [&](int i, int j) { mass(i, j) = mass(j, i) = std::sin(1.0 + i + 3 * j); };
    for (int i = 1; i < n; ++i) {
      if (kind == 0)
        couple(i, i - 1);
      else if (kind == 1)
        couple(i, 0);
      else if (kind == 2 && i < n - 1)
        couple(i, n - 1);
      else if (kind == 3 && i % 3 != 0)
        couple(i, i - i % 3);
      else if (kind == 4)
        for (int parent = (i - 1) / 2; parent > 0; parent = (parent - 1) / 2)
          couple(i, parent);
    }
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(n, -1, 2);
    MassMatrix factor(n);
    ASSERT_TRUE(factor.factorise(mass.data())) << kind;
    Eigen::VectorXd solution(n);
    factor.solve(right.data(), solution.data());
    EXPECT_LT((mass * solution - right).norm(), 1e-12) << kind;
    mass(7, 7) = -1;
    EXPECT_FALSE(factor.factorise(mass.data())) << kind;
  }
}

TEST(MassMatrix, ForgetsTheLastEnvelope) {
  MassMatrix factor(3);
  const Eigen::Matrix3d full = Eigen::Matrix3d::Identity() + Eigen::Matrix3d::Ones();
  Eigen::Matrix3d arrow = 3 * Eigen::Matrix3d::Identity();
  arrow(0, 1) = arrow(1, 0) = arrow(0, 2) = arrow(2, 0) = 1;
  for (const Eigen::Matrix3d &mass : {arrow, full, Eigen::Matrix3d(arrow.diagonal().asDiagonal()), arrow}) {
    ASSERT_TRUE(factor.factorise(mass.data()));
    Eigen::Vector3d solution(1, 2, 3);
    factor.solve(solution.data(), solution.data());
    EXPECT_LT((mass * solution - Eigen::Vector3d(1, 2, 3)).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace tf::runtime
