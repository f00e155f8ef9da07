#include "runtime/contact/semidefinite_factor.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>

namespace tf::runtime {
namespace {

void set(SemidefiniteFactor &factor, const Eigen::MatrixXd &matrix) {
  factor.resize(static_cast<int>(matrix.rows()));
  for (int j = 0; j < matrix.cols(); ++j)
    for (int i = j; i < matrix.rows(); ++i)
      factor.entry(i, j) = matrix(i, j);
}

// Rows of very different size, of every rank.
TEST(SemidefiniteFactor, SolvesConsistentSystemsOfEveryRank) {
  SemidefiniteFactor factor;
  for (int n = 1; n <= 24; ++n)
    for (int rank = 0; rank <= n; ++rank) {
      const Eigen::VectorXd sizes = Eigen::VectorXd::Random(n).unaryExpr([](double x) { return std::pow(10.0, 3 * x); });
      const Eigen::MatrixXd root = sizes.asDiagonal() * Eigen::MatrixXd::Random(n, rank);
      const Eigen::MatrixXd matrix = root * root.transpose();
      set(factor, matrix);
      EXPECT_EQ(factor.factor(1e-11), rank) << n;
      const Eigen::VectorXd right = root * Eigen::VectorXd::Random(rank);
      Eigen::VectorXd x = right;
      factor.solve(x.data(), x.data());
      EXPECT_LT((matrix * x - right).cwiseQuotient(sizes).norm(), 1e-9) << n << ' ' << rank;
    }
}

// Nearly dependent rows keep their residual small although the solution is large.
TEST(SemidefiniteFactor, RefinesIllConditionedSystems) {
  const int n = 40;
  Eigen::MatrixXd root = Eigen::MatrixXd::Random(n, n);
  for (int i = 1; i < n; ++i)
    root.row(i) = root.row(0) + 1e-2 * root.row(i);
  const Eigen::MatrixXd matrix = root * root.transpose();
  SemidefiniteFactor factor;
  set(factor, matrix);
  EXPECT_EQ(factor.factor(1e-13), n);
  const Eigen::VectorXd right = Eigen::VectorXd::Random(n);
  Eigen::VectorXd x(n);
  factor.solve(right.data(), x.data());
  EXPECT_LT((matrix * x - right).norm(), 1e-6);
}

}  // namespace
}  // namespace tf::runtime
