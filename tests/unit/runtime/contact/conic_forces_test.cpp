#include "runtime/contact/conic_forces.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace tf::runtime
