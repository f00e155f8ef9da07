#include "runtime/integrate/mass_matrix.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace tf::runtime
