#include "runtime/contact/lu_factor.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace tf::runtime {
namespace {

TEST(LuFactor, SolvesSystemsOfAllSizes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  LuFactor factor;
  for (int run = 0; run < 400; ++run) {
    const int n = run < 200 ? 1 + run % 4 : 1 + run % 60;
    Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return uniform(random); });
    if (run % 3 == 0)
      A(0, 0) = 0;  // needs an exchange of rows
    if (std::abs(A.determinant()) < 1e-6)
      continue;
    const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(random); });
    factor.matrix().resize(n, n);
    factor.matrix().map() = A;
    ASSERT_TRUE(factor.factor(0)) << "run " << run;
    Eigen::VectorXd b = A * x;
    factor.solve(b.data());
    ASSERT_LT((b - x).norm(), 1e-9) << "run " << run;
    b = A.transpose() * x;
    factor.solveTransposed(b.data());
    ASSERT_LT((b - x).norm(), 1e-9) << "run " << run;
  }
}

TEST(LuFactor, RefusesSingularAndInfiniteMatrices) {
  LuFactor factor;
  for (int n = 1; n <= 40; ++n) {
    factor.matrix().resize(n, n);
    factor.matrix().map().setOnes();
    EXPECT_EQ(factor.factor(1e-12), n == 1) << "size " << n;
    factor.matrix().map().setIdentity();
    factor.matrix()(n - 1, n - 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(factor.factor(0)) << "size " << n;
    factor.matrix().map().setIdentity();
    factor.matrix()(n - 1, n - 1) = 1e-12;
    EXPECT_FALSE(factor.factor(1e-11)) << "size " << n;
  }
}

}  // namespace
}  // namespace tf::runtime
