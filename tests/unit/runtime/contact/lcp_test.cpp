#include "runtime/contact/lcp.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace tf::runtime {
namespace {

double residual(LinearComplementarity &problem, const Eigen::MatrixXd &M, const Eigen::VectorXd &q, const std::vector<bool> &free) {
  const Eigen::Map<const Eigen::VectorXd> z(problem.z().data(), q.size());
  const Eigen::VectorXd w = M * z + q;
  double worst = 0;
  for (int k = 0; k < q.size(); ++k)
    worst = std::max(worst, free[k] ? std::abs(w(k)) : std::max({-z(k), -w(k), std::min(z(k), w(k))}));
  return worst;
}

void load(LinearComplementarity &problem, const Eigen::MatrixXd &M, const Eigen::VectorXd &q, const std::vector<bool> &free) {
  const int n = static_cast<int>(q.size());
  problem.resize(n);
  problem.matrix().map() = M;
  for (int k = 0; k < n; ++k) {
    problem.bias()[k] = q(k);
    if (free[k])
      problem.setFree(k);
  }
}

TEST(LinearComplementarity, OneRow) {
  LinearComplementarity problem;
  load(problem, Eigen::MatrixXd::Constant(1, 1, 2.0), Eigen::VectorXd::Constant(1, -3.0), {false});
  ASSERT_EQ(problem.solve(0), LinearComplementarity::Status::Solved);
  EXPECT_DOUBLE_EQ(problem.z()[0], 1.5);
}

TEST(LinearComplementarity, PositiveBiasNeedsNoPivot) {
  LinearComplementarity problem;
  load(problem, Eigen::MatrixXd::Identity(3, 3), Eigen::VectorXd::Ones(3), {false, false, false});
  ASSERT_EQ(problem.solve(0), LinearComplementarity::Status::Solved);
  EXPECT_EQ(problem.pivots(), 0);
  EXPECT_EQ(problem.z(), (std::vector<double>{0, 0, 0}));
}

TEST(LinearComplementarity, NegativeMatrixEndsInARay) {
  LinearComplementarity problem;
  load(problem, Eigen::MatrixXd::Constant(1, 1, -1.0), Eigen::VectorXd::Constant(1, -1.0), {false});
  EXPECT_EQ(problem.solve(0), LinearComplementarity::Status::Ray);
}

TEST(LinearComplementarity, RandomPositiveSemidefinite) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  LinearComplementarity problem;
  for (int run = 0; run < 500; ++run) {
    const int n = 1 + run % 25, rank = 1 + run % 17;
    const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(n, rank, [&] { return uniform(random); });
    const Eigen::MatrixXd S = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return uniform(random); });
    const Eigen::MatrixXd M = J * J.transpose() + (run % 2 ? 1.0 : 0.0) * (S - S.transpose());
    // Feasible by construction: some z, w ≥ 0 with w = M z + q.
    Eigen::VectorXd z = Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(random); }).cwiseMax(0);
    Eigen::VectorXd w = Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(random); }).cwiseMax(0);
    const Eigen::VectorXd q = w - M * z;
    const std::vector<bool> free(n, false);
    load(problem, M, q, free);
    ASSERT_EQ(problem.solve(1e-9), LinearComplementarity::Status::Solved) << "run " << run;
    ASSERT_LT(residual(problem, M, q, free), 1e-9) << "run " << run;
  }
}

TEST(LinearComplementarity, FreeRowsAreEquationsDependentOnesIncluded) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  LinearComplementarity problem;
  for (int run = 0; run < 300; ++run) {
    const int n = 3 + run % 12, rank = 2 + run % 9;
    const Eigen::MatrixXd J = Eigen::MatrixXd::NullaryExpr(n, rank, [&] { return uniform(random); });
    const Eigen::MatrixXd M = J * J.transpose();
    const Eigen::VectorXd q = J * Eigen::VectorXd::NullaryExpr(rank, [&] { return uniform(random); });
    std::vector<bool> free(n);
    for (int k = 0; k < n; ++k)
      free[k] = k % 3 == 0;
    load(problem, M, q, free);
    ASSERT_EQ(problem.solve(1e-9), LinearComplementarity::Status::Solved) << "run " << run;
    ASSERT_LT(residual(problem, M, q, free), 1e-8) << "run " << run;
  }
}

TEST(LinearComplementarity, ContradictoryFreeRows) {
  LinearComplementarity problem;
  Eigen::VectorXd q(2);
  q << -1, -2;
  load(problem, Eigen::MatrixXd::Ones(2, 2), q, {true, true});
  EXPECT_EQ(problem.solve(1e-9), LinearComplementarity::Status::Contradictory);
}

// Equal rows: every ratio test is a tie.
TEST(LinearComplementarity, DegenerateTiesEnd) {
  const int n = 8;
  Eigen::MatrixXd M = Eigen::MatrixXd::Ones(n, n);
  LinearComplementarity problem;
  const std::vector<bool> free(n, false);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(n, -1.0);
  load(problem, M, q, free);
  ASSERT_EQ(problem.solve(1e-12), LinearComplementarity::Status::Solved);
  EXPECT_LT(residual(problem, M, q, free), 1e-14);
}

}  // namespace
}  // namespace tf::runtime
