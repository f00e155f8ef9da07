#include "runtime/contact/admissible_impulse.h"

#include <Eigen/Dense>

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace tf::runtime {
namespace {

// A sphere of radius 1 that touches the floor z = −1 and the wall x = −1 and sticks to both: an internal force along the line through both
// points is redundant. Rows: normals (floor z, wall x), slips (floor x, y; wall y, z); velocities (v, ω).
struct Corner {
  Eigen::MatrixXd rows{6, 6};
  FrozenProblem problem;

  explicit Corner(double friction) {
    rows << 0, 0, 1, 0, 0, 0,  //
        1, 0, 0, 0, 0, 0,      //
        1, 0, 0, 0, -1, 0,     //
        0, 1, 0, 1, 0, 0,      //
        0, 1, 0, 0, 0, -1,     //
        0, 0, 1, 0, 1, 0;
    Eigen::VectorXd mobility(6);
    mobility << 1, 1, 1, 2.5, 2.5, 2.5;
    const Eigen::MatrixXd D = rows * mobility.asDiagonal() * rows.transpose();
    problem.resize(2, 4);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        problem.delassus(i, j) = D(i, j);
    problem.owner = {0, 0, 1, 1};
    problem.partner = {1, 0, 3, 2};
    problem.friction = {friction, friction, friction, friction};
    problem.resolution = 1e-13;
  }
};

double slack(const FrozenProblem &problem, const std::vector<double> &impulse, int j) {
  const auto first = static_cast<std::size_t>(2 + j);
  return problem.friction[j] * impulse[static_cast<std::size_t>(problem.owner[j])] - std::hypot(impulse[first], impulse[first + 1]);
}

TEST(AdmissibleImpulse, MakesTheSameMotionFromWithinTheCones) {
  const Corner corner(0.4);
  std::vector<double> impulse = {0.06, 0.0012, 0.0304, 0, 0, 0.0304};
  ASSERT_LT(slack(corner.problem, impulse, 2), 0);
  const std::vector<double> before = impulse, stuck(6, 0.0);
  AdmissibleImpulse admissible;
  admissible.choose(corner.problem, stuck, impulse);
  for (const int j : {0, 2})
    EXPECT_GE(slack(corner.problem, impulse, j), -1e-12) << j;
  const Eigen::Map<const Eigen::VectorXd> old(before.data(), 6), now(impulse.data(), 6);
  EXPECT_LT((corner.rows.transpose() * (now - old)).norm(), 1e-12);
  EXPECT_GT((now - old).norm(), 1e-3);
}

TEST(AdmissibleImpulse, KeepsWhatIsAdmissibleOrCannotBe) {
  const Corner corner(0.4);
  AdmissibleImpulse admissible;
  const std::vector<double> stuck(6, 0.0);
  std::vector<double> inside = {0.06, 0.03, 0.01, 0, 0, 0.01};
  const std::vector<double> before = inside;
  admissible.choose(corner.problem, stuck, inside);
  EXPECT_EQ(inside, before);
  // Across the line through the points nothing is redundant.
  std::vector<double> outside = {0.06, 0.03, 0, 0.05, 0, 0};
  const std::vector<double> kept = outside;
  admissible.choose(corner.problem, stuck, outside);
  EXPECT_EQ(outside, kept);
}

TEST(AdmissibleImpulse, KeepsWhatSlides) {
  const Corner corner(0.4);
  AdmissibleImpulse admissible;
  std::vector<double> impulse = {0.06, 0.0012, 0.0304, 0, 0, 0.0304};
  const std::vector<double> before = impulse;
  admissible.choose(corner.problem, {0, 0, 0.1, 0, 0, 0}, impulse);
  EXPECT_EQ(impulse, before);
}

}  // namespace
}  // namespace tf::runtime
