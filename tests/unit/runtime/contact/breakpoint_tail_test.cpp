#include "runtime/contact/breakpoint_tail.h"

#include "runtime/contact/frozen_phase.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tf::runtime {
namespace {

TEST(BreakpointTail, SumsAGeometricCycle) {
  BreakpointTail tail;
  tail.reset(2, 2);
  double size = 1, total = 0;
  for (int cycle = 0; cycle < 3; ++cycle) {
    for (const int row : {4, 7}) {
      EXPECT_FALSE(tail.repeats());
      const std::array<double, 2> increment{row == 4 ? size : 0.5 * size, row == 4 ? -size : size};
      tail.add(row, increment);
      total += increment[0];
    }
    size *= 0.25;
  }
  ASSERT_TRUE(tail.repeats());
  EXPECT_EQ(tail.period(), 2);
  EXPECT_DOUBLE_EQ(tail.factor(), 0.25);
  EXPECT_DOUBLE_EQ(total + tail.tail(0), 1.5 / 0.75);
  EXPECT_DOUBLE_EQ(tail.tail(1), 0);
  EXPECT_GT(tail.variation(1), 0);
}

TEST(BreakpointTail, DoesNotTakeAChangingFactorForATail) {
  BreakpointTail tail;
  tail.reset(1, 1);
  for (int k = 0; k < 40; ++k) {
    const std::array<double, 1> increment{1.0 / (1 + k * k)};
    tail.add(3, increment);
    EXPECT_FALSE(tail.repeats());
  }
}

// Seven contacts with μ ≈ 2 of which three repeat a sequence of slips and compressions without contraction, until another contact, slowly
// relieved, ends it: equal cycles are summed exactly.
TEST(BreakpointTail, EqualCyclesAreSummedUntilSomethingElseChanges) {
  Eigen::MatrixXd J(14, 4);
  J << 1, 1, -1, 1, 1, 1, 1, 1, 1, -1, -1, 0, 1, -1, -1, -1, 1, 0, 0, 0, 1, -1, 1, 1, 1, -1, 1, 1,  //
      -1, 1, 1, 0, 1, -1, 0, -1, 0, -1, -1, -1, 0, 0, 0, -1, 0, 1, 0, -1, -1, 0, -1, 0, 1, 0, 0, -1;
  FrozenProblem problem;
  problem.resize(7, 7);
  problem.delassus.map() = J * J.transpose();
  problem.normalVelocity = {-6, -2, -2, -2, -2, 2, 2};
  problem.slipVelocity = {2, 0, 0, 0, -2, 0, -2};
  for (int i = 0; i < 7; ++i) {
    problem.owner[i] = i;
    problem.friction[i] = 1.95368;
  }
  FrozenPhase summing, following({.sumTails = false});
  const FrozenResult &sum = summing.run(problem);
  const FrozenResult &path = following.run(problem);
  ASSERT_EQ(sum.status, FrozenStatus::Finished);
  ASSERT_EQ(path.status, FrozenStatus::Finished);
  EXPECT_LT(sum.breakpointCount, 100);
  EXPECT_GT(path.breakpointCount, 1000);
  EXPECT_NEAR(sum.duration, path.duration, 1e-10);
  for (int r = 0; r < 14; ++r) {
    EXPECT_NEAR(sum.velocity[r], path.velocity[r], 1e-9);
    EXPECT_NEAR(sum.impulse[r], path.impulse[r], 1e-9);
  }
}

}  // namespace
}  // namespace tf::runtime
