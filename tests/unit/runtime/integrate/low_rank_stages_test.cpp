#include "runtime/integrate/low_rank_stages.h"

#include <cmath>
#include <gtest/gtest.h>

namespace tf::runtime {
namespace {

constexpr int stateCount = 7;
constexpr double stepLength = 0.3;

// The residual of the equations with the coefficients of two stages, all of them in one matrix.
double residualOf(LowRankStages &equations) {
  const std::vector<double> a = {5.0 / 12, -1.0 / 12, 0.75, 0.25};
  Eigen::MatrixXd whole = Eigen::MatrixXd::Identity(2 * stateCount, 2 * stateCount);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      whole.block(i * stateCount, j * stateCount, stateCount, stateCount) -=
          stepLength * a[static_cast<std::size_t>(2 * i + j)] * equations.left(j) * equations.right(j).transpose();
  equations.factorise(stepLength);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(2 * stateCount, -1, 2);
  Eigen::VectorXd solution = right;
  equations.solve(solution);
  return (whole * solution - right).lpNorm<Eigen::Infinity>() / solution.lpNorm<Eigen::Infinity>();
}

void fill(LowRankStages &equations, int rank, double stiffness) {
  equations.setRank(rank);
  for (int stage = 0; stage < 2; ++stage)
    for (int k = 0; k < rank; ++k)
      for (int i = 0; i < stateCount; ++i) {
        equations.left(stage)(i, k) = -stiffness * std::sin(1.0 + i + 3 * k + 5 * stage);
        equations.right(stage)(i, k) = std::sin(1.1 + i + 3 * k + 5 * stage);
      }
}

TEST(LowRankStages, SolvesTheEquationsOfAllStages) {
  LowRankStages equations(stateCount, {5.0 / 12, -1.0 / 12, 0.75, 0.25});
  for (const int rank : {1, 3}) {
    fill(equations, rank, 1);
    EXPECT_LT(residualOf(equations), 1e-14) << rank;
    fill(equations, rank, 1e6);
    EXPECT_LT(residualOf(equations), 1e-8) << rank;
  }
}

TEST(LowRankStages, WithoutJacobiansTheStagesAreTheRightHandSides) {
  LowRankStages equations(stateCount, {5.0 / 12, -1.0 / 12, 0.75, 0.25});
  EXPECT_EQ(residualOf(equations), 0);
}

}  // namespace
}  // namespace tf::runtime
