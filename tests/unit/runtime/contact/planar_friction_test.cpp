#include "runtime/contact/planar_friction.h"

#include <gtest/gtest.h>

namespace tf::runtime {
namespace {

// Equal balls that rest against one another in a row, the first of which is pushed: contact i carries 1 − i/n. Each iteration of an active
// set that starts with open contacts would close one of them.
TEST(PlanarFriction, RowOfRestingContactsIsHeldAtOnce) {
  constexpr int count = 60;
  PlanarFrictionSolver solver;
  PlanarFrictionProblem &problem = solver.problem();
  problem.resize(count, 0);
  for (int i = 0; i < count; ++i) {
    problem.delassus(i, i) = 2;
    problem.upper[i] = 1;
    if (i > 0)
      problem.delassus(i, i - 1) = problem.delassus(i - 1, i) = -1;
  }
  problem.normalKind[0] = NormalKind::Prescribed;
  const PlanarFrictionSolution &found = solver.solve(nullptr, 1e-9);
  ASSERT_EQ(found.status, PlanarFrictionSolution::Status::Solved);
  EXPECT_EQ(solver.path(), PlanarFrictionSolver::Path::ActiveSet);
  for (int i = 0; i < count; ++i)
    EXPECT_NEAR(found.force[i], 1 - static_cast<double>(i) / count, 1e-12);
  for (int i = 1; i < count; ++i)
    EXPECT_EQ(found.mode.normal[i], NormalState::Active);
}

}  // namespace
}  // namespace tf::runtime
