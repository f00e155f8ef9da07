#include "runtime/contact/conic_forces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tf::runtime {
namespace {

// sideᵀ (x0, x1, x2) = width with x ≥ 0, beside a force x3 = 1.
void poseTriangle(ConicForces &forces, const Eigen::RowVector3d &side, double width) {
  forces.resize(4, 3);
  forces.matrix().setZero();
  forces.matrix().row(0).head(3) = side;
  forces.matrix()(1, 3) = 1;
  forces.rhs() << width, 1, 0, 0;
  for (int k = 0; k < 3; ++k) {
    forces.limit(k) = {};
    forces.limit(k).apex = k;
    forces.limit(k).factor = 1 + 0.5 * k;
  }
}

TEST(ConicForces, LeastNormOfATriangle) {
  ConicForces forces;
  poseTriangle(forces, {1, 2, 3}, 1.4);
  ASSERT_TRUE(forces.prepare(1e-9));
  EXPECT_GT(forces.largestSlack(), 0.1);
  const Eigen::VectorXd &least = forces.leastNorm();
  EXPECT_LT((least - Eigen::Vector4d(0.1, 0.2, 0.3, 1)).lpNorm<Eigen::Infinity>(), 1e-6);
}

TEST(ConicForces, EquationsOfFullRankHaveOneSolution) {
  ConicForces forces;
  forces.resize(2, 2);
  forces.matrix() << 2, 1, 0, 1;
  forces.rhs() << 5, 1;
  for (int k = 0; k < 2; ++k) {
    forces.limit(k) = {};
    forces.limit(k).apex = k;
    forces.limit(k).factor = 1;
  }
  ASSERT_TRUE(forces.prepare(1e-9));
  EXPECT_NEAR(forces.largestSlack(), 1, 1e-14);
  const Eigen::Vector2d solution(2, 1);
  EXPECT_LT((forces.innermost() - solution).norm(), 1e-14);
  EXPECT_LT((forces.leastNorm() - solution).norm(), 1e-14);
}

// Of a triangle as thin as what counts as zero all three sides are active, more than its points have coordinates.
TEST(ConicForces, LeastNormOfAThinTriangleIsInIt) {
  constexpr double width = 1e-7;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(0.3, 3);
  for (int trial = 0; trial < 200; ++trial) {
    ConicForces forces;
    const Eigen::RowVector3d sides(side(random), side(random), side(random));
    poseTriangle(forces, sides, width);
    ASSERT_TRUE(forces.prepare(1e-9));
    ASSERT_GT(forces.largestSlack(), 0);
    const Eigen::VectorXd &least = forces.leastNorm();
    EXPECT_GE(forces.smallestSlack(least), -1e-13) << trial;
    EXPECT_LE(least.head(3).maxCoeff(), 4 * width) << trial;
    EXPECT_NEAR(least[3], 1, 1e-14);
  }
}

// Variables of the one alternate with those of the other; both are what they are alone.
TEST(ConicForces, PartsDoNotMatterToOneAnother) {
  constexpr int copies = 2;
  const Eigen::RowVector3d sides[copies] = {{1, 2, 3}, {0.5, 1, 0.7}};
  const double widths[copies] = {1.4, 0.9};
  ConicForces both;
  both.resize(4 * copies, 3 * copies);
  both.matrix().setZero();
  Eigen::VectorXd points[copies], multipliers[copies], along = Eigen::VectorXd::Zero(4 * copies), found;
  for (int copy = 0; copy < copies; ++copy) {
    ConicForces one;
    poseTriangle(one, sides[copy], widths[copy]);
    for (int k = 0; k < 4; ++k) {
      for (int c = 0; c < 4; ++c)
        both.matrix()(copies * k + copy, copies * c + copy) = one.matrix()(k, c);
      both.rhs()[copies * k + copy] = one.rhs()[k];
    }
    for (int k = 0; k < 3; ++k) {
      both.limit(copies * k + copy) = one.limit(k);
      both.limit(copies * k + copy).apex = copies * k + copy;
    }
    ASSERT_TRUE(one.prepare(1e-9));
    one.multipliersOf(one.freePoint(), multipliers[copy]);
    ASSERT_GT(one.largestSlack(), 0.1);
    points[copy] = one.leastNorm();
  }
  ASSERT_TRUE(both.prepare(1e-9));
  both.multipliersOf(both.freePoint(), found);
  ASSERT_GT(both.largestSlack(), 0.1);
  const Eigen::VectorXd &least = both.leastNorm();
  for (int copy = 0; copy < copies; ++copy)
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(least[copies * k + copy], points[copy][k], 1e-12) << copy << ' ' << k;
      EXPECT_NEAR(found[copies * k + copy], multipliers[copy][k], 1e-14) << copy << ' ' << k;
    }
  along[0] = 2;
  Eigen::VectorXd left = Eigen::VectorXd::Ones(4 * copies);
  both.subtractProduct(along, left);
  EXPECT_LT((left - (Eigen::VectorXd::Ones(4 * copies) - both.matrix() * along)).lpNorm<Eigen::Infinity>(), 1e-15);
  // Of nothing on the right-hand side of one part, nothing of its solution.
  both.solve(along, found);
  for (int k = 0; k < 4; ++k)
    EXPECT_EQ(found[copies * k + 1], 0);
}

// Four contacts with friction in two directions, a normal force and its tangential ones after the other, of which six equations hold, the
// others being sums of these: as a body on four feet that is drawn at ever harder.
void poseBody(ConicForces &forces, const Eigen::Matrix<double, 6, 12> &equations, const Eigen::VectorXd &rhs) {
  forces.resize(12, 8);
  forces.matrix().topRows(6) = equations;
  forces.matrix().bottomRows(6) = equations + equations.colwise().reverse();
  forces.rhs().head(6) = rhs;
  forces.rhs().tail(6) = rhs + rhs.reverse();
  for (int k = 0; k < 4; ++k) {
    forces.limit(2 * k) = {3 * k, 1, 0, -1, -1};
    forces.limit(2 * k + 1) = {3 * k, 0.5, 0, 3 * k + 1, 3 * k + 2};
  }
}

TEST(ConicForces, PointsAreFollowedUntilTheSetIsEmpty) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  int emptied = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::Matrix<double, 6, 12> equations;
    for (double &entry : equations.reshaped())
      entry = normal(random);
    Eigen::VectorXd begin(12), pull(6);
    for (int k = 0; k < 4; ++k)
      begin.segment(3 * k, 3) << 1, 0.2 * std::cos(k), 0.2 * std::sin(k);
    for (double &entry : pull)
      entry = normal(random);
    ConicForces followed;
    double slack = 1;
    for (int step = 0; step <= 200 && slack > 1e-6; ++step) {
      const Eigen::VectorXd rhs = equations * begin + 0.05 * step * pull;
      poseBody(followed, equations, rhs);
      ASSERT_TRUE(followed.prepare(1e-9));
      slack = followed.largestSlack();
      ConicForces afresh;
      poseBody(afresh, equations, rhs);
      ASSERT_TRUE(afresh.prepare(1e-9));
      EXPECT_NEAR(slack, afresh.largestSlack(), 2e-6 * afresh.scale()) << trial << ' ' << step;
      if (slack <= 1e-6)
        break;
      const Eigen::VectorXd *found = followed.followLeastNorm();
      const Eigen::VectorXd &least = found != nullptr ? *found : followed.leastNorm();
      EXPECT_LT((least - afresh.leastNorm()).lpNorm<Eigen::Infinity>(), 1e-7 * afresh.scale()) << trial << ' ' << step;
      EXPECT_GE(followed.smallestSlack(least), -1e-12 * afresh.scale()) << trial << ' ' << step;
    }
    emptied += slack <= 1e-6 ? 1 : 0;
  }
  EXPECT_GT(emptied, 10);
}

}  // namespace
}  // namespace tf::runtime
