#include "runtime/contact/single_contact_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tf::runtime {
namespace {

// A contact with D = J W Jᵀ of random rows; half of them without friction, a third with a slip that is zero.
FrozenProblem randomContact(std::mt19937 &random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const bool rubs = uniform(random) < 0.5;
  FrozenProblem problem;
  problem.resize(1, rubs ? 1 : 0);
  const double normal = 0.2 + uniform(random), tangent = 0.2 + uniform(random), cosine = 1.8 * uniform(random) - 0.9;
  problem.delassus(0, 0) = normal;
  problem.normalVelocity[0] = -3 * uniform(random);
  problem.rate[0] = 0.5 + uniform(random);
  problem.restitution[0] = uniform(random) < 0.3 ? 0 : uniform(random);
  problem.law[0] = static_cast<ImpactLaw>(static_cast<int>(3 * uniform(random)));
  if (rubs) {
    problem.delassus(1, 1) = tangent;
    problem.delassus(0, 1) = problem.delassus(1, 0) = cosine * std::sqrt(normal * tangent);
    problem.owner[0] = 0;
    problem.friction[0] = 1.5 * uniform(random);
    problem.slipVelocity[0] = uniform(random) < 0.33 ? 0 : 4 * uniform(random) - 2;
  }
  return problem;
}

TEST(SingleContactPhase, FollowsThePathOfTheFrozenPhase) {
  std::mt19937 random(11);
  SingleContactPhase single;
  FrozenPhase general;
  int found = 0;
  constexpr int runs = 20000;
  for (int run = 0; run < runs; ++run) {
    const FrozenProblem problem = randomContact(random);
    const FrozenResult *closedForm = single.run(problem);
    if (closedForm == nullptr)
      continue;
    ++found;
    const FrozenResult &expected = general.run(problem);
    ASSERT_EQ(expected.status, FrozenStatus::Finished) << run;
    ASSERT_NEAR(closedForm->duration, expected.duration, 1e-12 * (1 + expected.duration)) << run;
    for (int row = 0; row < problem.count(); ++row) {
      ASSERT_NEAR(closedForm->impulse[row], expected.impulse[row], 1e-12 * (1 + std::abs(expected.impulse[row]))) << run;
      ASSERT_NEAR(closedForm->velocity[row], expected.velocity[row], 1e-11 * (1 + std::abs(expected.velocity[row]))) << run;
    }
  }
  EXPECT_GT(found, 0.8 * runs);
}

TEST(SingleContactPhase, LeavesOtherCasesToTheFrozenPhase) {
  SingleContactPhase single;
  FrozenProblem two;
  two.resize(2, 0);
  two.delassus(0, 0) = two.delassus(1, 1) = 1;
  two.normalVelocity = {-1, -1};
  EXPECT_EQ(single.run(two), nullptr);
  // Friction presses the contact in, D_s = D_nn + μ D_nt < 0 for a slip to the left.
  FrozenProblem jammed;
  jammed.resize(1, 1);
  jammed.delassus(0, 0) = 1;
  jammed.delassus(0, 1) = jammed.delassus(1, 0) = -1.5;
  jammed.delassus(1, 1) = 4;
  jammed.owner[0] = 0;
  jammed.friction[0] = 1;
  jammed.normalVelocity[0] = -1;
  jammed.slipVelocity[0] = -2;
  EXPECT_EQ(single.run(jammed), nullptr);
}

}  // namespace
}  // namespace tf::runtime
