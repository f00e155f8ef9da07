#include "runtime/contact/least_norm.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace tf::runtime {
namespace {

void set(LeastNorm &problem, int constraint, const std::vector<double> &normal, double bound) {
  std::copy(normal.begin(), normal.end(), problem.normal(constraint));
  problem.bound(constraint) = bound;
}

TEST(LeastNorm, EquationsAlone) {
  LeastNorm problem;
  problem.resize(3, 1, 0);
  set(problem, 0, {1, 1, 1}, 6);
  ASSERT_EQ(problem.solve(1e-12, 1e-12), LeastNorm::Status::Solved);
  for (const double x : problem.point())
    EXPECT_NEAR(x, 2, 1e-15);
  EXPECT_FALSE(problem.dependent());
}

TEST(LeastNorm, DependentEquationsAreLeftOut) {
  LeastNorm problem;
  problem.resize(2, 2, 0);
  set(problem, 0, {0.6, 0.8}, 1);
  set(problem, 1, {0.6, 0.8}, 1);
  ASSERT_EQ(problem.solve(1e-12, 1e-12), LeastNorm::Status::Solved);
  EXPECT_TRUE(problem.dependent());
  EXPECT_NEAR(problem.point()[1], 0.8, 1e-15);
  problem.bound(1) = 2;
  EXPECT_EQ(problem.solve(1e-12, 1e-12), LeastNorm::Status::Contradictory);
}

TEST(LeastNorm, InequalityBecomesActive) {
  LeastNorm problem;  // x + y = 2, x ≥ 1.5
  problem.resize(2, 1, 1);
  set(problem, 0, {std::sqrt(0.5), std::sqrt(0.5)}, std::sqrt(2.0));
  set(problem, 1, {1, 0}, 1.5);
  ASSERT_EQ(problem.solve(1e-12, 1e-12), LeastNorm::Status::Solved);
  EXPECT_NEAR(problem.point()[0], 1.5, 1e-15);
  EXPECT_NEAR(problem.point()[1], 0.5, 1e-15);
  EXPECT_EQ(problem.active().size(), 2u);
  EXPECT_GT(problem.multipliers()[1], 0);
}

TEST(LeastNorm, EmptySetIsProved) {
  LeastNorm problem;  // x + y = 2, x ≥ 1.5, y ≥ 1
  problem.resize(2, 1, 2);
  set(problem, 0, {std::sqrt(0.5), std::sqrt(0.5)}, std::sqrt(2.0));
  set(problem, 1, {1, 0}, 1.5);
  set(problem, 2, {0, 1}, 1);
  EXPECT_EQ(problem.solve(1e-12, 1e-12), LeastNorm::Status::Empty);
}

TEST(LeastNorm, CrossingSwapsTheActiveInequalityOrEmptiesTheSet) {
  LeastNorm problem;  // x + y = 2, x ≥ 1.5, y ≥ 0.5: one point
  problem.resize(2, 1, 2);
  set(problem, 0, {std::sqrt(0.5), std::sqrt(0.5)}, std::sqrt(2.0));
  set(problem, 1, {1, 0}, 1.5);
  set(problem, 2, {0, 1}, 0.5);
  ASSERT_EQ(problem.solve(1e-12, 1e-12), LeastNorm::Status::Solved);
  EXPECT_EQ(problem.activate(2), LeastNorm::Status::Empty);

  problem.resize(2, 0, 2);  // two bounds on the same side: the second takes over
  set(problem, 0, {1, 0}, 1);
  set(problem, 1, {1, 0}, 1);
  ASSERT_EQ(problem.solve(1e-12, 1e-12), LeastNorm::Status::Solved);
  const int other = problem.active()[0] == 0 ? 1 : 0;
  EXPECT_EQ(problem.activate(other), LeastNorm::Status::Solved);
  EXPECT_EQ(problem.active(), std::vector<int>{other});
}

// Variables that no active constraint tells apart have equal values; a constraint that becomes active tells them apart.
TEST(LeastNorm, EqualVariablesShareUntilAConstraintTellsThemApart) {
  constexpr int variables = 20, sets = 4, equations = 3;
  LeastNorm problem;
  problem.resize(variables, equations, 1);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  Eigen::MatrixXd normals(variables, equations + 1);
  Eigen::VectorXd bounds(equations + 1);
  normals.setZero();
  for (int c = 0; c < equations; ++c) {
    for (int i = 0; i < sets; ++i)
      normals(i, c) = uniform(random);
    for (int i = sets; i < variables; ++i)
      normals(i, c) = normals(i % sets, c);
    bounds[c] = uniform(random);
  }
  normals(5, equations) = 1;
  bounds[equations] = -100;
  const auto load = [&] {
    for (int c = 0; c <= equations; ++c) {
      std::copy_n(normals.col(c).data(), variables, problem.normal(c));
      problem.bound(c) = bounds[c];
    }
  };
  const auto expectLeast = [&](int count) {
    const Eigen::MatrixXd active = normals.leftCols(count);
    const Eigen::VectorXd multipliers = (active.transpose() * active).ldlt().solve(bounds.head(count)), point = active * multipliers;
    for (int i = 0; i < variables; ++i)
      EXPECT_NEAR(problem.point()[i], point[i], 1e-13) << i;
    for (int k = 0; k < count; ++k)
      EXPECT_NEAR(problem.multipliers()[k], multipliers[k], 1e-12) << k;
  };
  load();
  ASSERT_EQ(problem.solve(1e-12, 1e-12), LeastNorm::Status::Solved);
  load();
  ASSERT_TRUE(problem.solveActive());
  expectLeast(equations);
  bounds[equations] = problem.point()[5];
  load();
  ASSERT_EQ(problem.activate(equations), LeastNorm::Status::Solved);
  bounds[equations] += 0.1;
  load();
  ASSERT_TRUE(problem.solveActive());
  expectLeast(equations + 1);
  std::vector<double> point(variables);
  problem.pointOf(bounds.data(), point.data());
  for (int i = 0; i < variables; ++i)
    EXPECT_NEAR(point[i], problem.point()[i], 1e-14);
  problem.release(equations);
  ASSERT_TRUE(problem.solveActive());
  expectLeast(equations);
}

// Optimality (Karush, Kuhn, Tucker) is sufficient, as the problem is strictly convex.
// Of a point in the plane x + y + z = 3, x ≥ 1, y ≥ 0, z ≥ 0: x grows until y and z are zero; x + y + z ≥ 2 has always the slack 1.
TEST(LeastNorm, SlackGrowsUntilAnotherInequalityIsMet) {
  const double third = 1 / std::sqrt(3.0);
  LeastNorm problem;
  problem.resize(3, 1, 4);
  set(problem, 0, {third, third, third}, 3 * third);
  set(problem, 1, {1, 0, 0}, 1);
  set(problem, 2, {0, 1, 0}, 0);
  set(problem, 3, {0, 0, 1}, 0);
  set(problem, 4, {third, third, third}, 2 * third);
  ASSERT_EQ(problem.solve(1e-12, 1e-12), LeastNorm::Status::Solved);
  const std::vector<double> point = problem.point();
  EXPECT_NEAR(problem.slackWithinReach(1), 2, 1e-13);
  EXPECT_FALSE(problem.isFixed());
  EXPECT_NEAR(problem.slackWithinReach(4), third, 1e-14);
  EXPECT_TRUE(problem.isFixed());
  EXPECT_EQ(problem.point(), point);
}

TEST(LeastNorm, RandomPolyhedraAreSolvedToOptimality) {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> uniform(-1, 1);
  LeastNorm problem;
  int degenerate = 0;
  for (int run = 0; run < 1000; ++run) {
    const int n = 1 + run % 12, equations = run % 3, inequalities = run % 20;
    problem.resize(n, equations, inequalities);
    const Eigen::VectorXd inside = Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(random); });
    const Eigen::VectorXd origin = Eigen::VectorXd::NullaryExpr(n, [&] { return 3 * uniform(random); });
    Eigen::MatrixXd N(n, equations + inequalities);
    Eigen::VectorXd c(equations + inequalities);
    for (int k = 0; k < N.cols(); ++k) {
      Eigen::VectorXd normal = Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(random); }).normalized();
      if ((k > 2 && k % 5 == 0) || (k == 1 && equations == 2 && run % 5 == 0))
        normal = N.col(k - 1);
      N.col(k) = normal;
      const bool tight = run % 4 == 0 && k % 2 == 0;
      c(k) = normal.dot(inside) - (k < equations || tight ? 0.0 : std::abs(uniform(random)));
      set(problem, k, {normal.begin(), normal.end()}, c(k));
    }
    for (int k = 0; k < n; ++k)
      problem.origin(k) = origin(k);
    const auto status = problem.solve(1e-11, 1e-9);
    ASSERT_EQ(status, LeastNorm::Status::Solved) << "run " << run;
    degenerate += problem.dependent() ? 1 : 0;
    const Eigen::Map<const Eigen::VectorXd> x(problem.point().data(), n);
    Eigen::VectorXd gradient = x - origin;
    for (std::size_t k = 0; k < problem.active().size(); ++k) {
      const int constraint = problem.active()[k];
      gradient -= N.col(constraint) * problem.multipliers()[k];
      ASSERT_LT(std::abs(N.col(constraint).dot(x) - c(constraint)), 1e-9) << "run " << run;
      if (constraint >= equations) {
        ASSERT_GE(problem.multipliers()[k], -1e-10) << "run " << run;
      }
    }
    ASSERT_LT(gradient.norm(), 1e-8) << "run " << run;
    for (int k = equations; k < N.cols(); ++k)
      ASSERT_GE(N.col(k).dot(x) - c(k), -1e-10) << "run " << run;
    // What is within reach is there: as far along the normal as one may go.
    LeastNorm far = problem;
    for (int k = equations; k < N.cols(); ++k) {
      const double reach = problem.slackWithinReach(k);
      ASSERT_GE(reach, problem.slack(k) - 1e-12) << "run " << run;
      for (int i = 0; i < n; ++i)
        far.origin(i) = x[i] + 1e7 * N(i, k);
      ASSERT_EQ(far.solveAgain(1e-6, 1e-6), LeastNorm::Status::Solved) << "run " << run;
      ASSERT_GE(far.slack(k), std::min(reach, 100.0) - 1e-4) << "run " << run;
      ASSERT_TRUE(!problem.isFixed() || far.slack(k) < reach + 1e-4) << "run " << run;
    }
    // The same active set again gives the same point.
    const Eigen::VectorXd before = x;
    ASSERT_TRUE(problem.solveActive()) << "run " << run;
    ASSERT_LT((Eigen::Map<const Eigen::VectorXd>(problem.point().data(), n) - before).norm(), 1e-8) << "run " << run;
  }
  EXPECT_GT(degenerate, 10);
}

}  // namespace
}  // namespace tf::runtime
