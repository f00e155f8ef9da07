#include "runtime/contact/frozen_phase.h"

#include "tests/unit/runtime/contact/mechanisms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

namespace tf::runtime {
namespace {

using test::body;
using test::frozen;
using test::velocityAfter;

constexpr double pi = std::numbers::pi;

TEST(FrozenPhase, ParticleStopsAfterTheTimeOfTheFormula) {
  FrozenProblem problem;  // D = 1/m, c2 = −5: τ = −c2/(a D)
  problem.resize(1, 0);
  problem.delassus(0, 0) = 0.5;
  problem.normalVelocity[0] = -5;
  problem.rate[0] = 4;
  FrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  EXPECT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_DOUBLE_EQ(result.duration, 5 / (4 * 0.5));
  EXPECT_DOUBLE_EQ(result.impulse[0], 10);
  EXPECT_EQ(result.velocity[0], 0.0);
  EXPECT_EQ(result.breakpointCount, 1);
  ASSERT_EQ(phase.breakpoints().size(), 2u);
  EXPECT_EQ(phase.breakpoints()[0].event, FrozenEvent::Start);
  EXPECT_EQ(phase.breakpoints()[1].event, FrozenEvent::Separation);
}

TEST(FrozenPhase, SlidingImpactTakesDsInPlaceOfD) {
  const double mu = 0.3, th = 0.4;
  const auto rod = body(1, 1.0 / 12, th, {{-0.5, 0}}, mu);
  const Eigen::Vector3d v(9, -1, 0);
  const FrozenProblem problem = frozen(rod, v, {0});
  const double Ds = problem.delassus(0, 0) - mu * problem.delassus(0, 1);
  FrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  EXPECT_NEAR(result.duration, 1 / Ds, 1e-14);
  EXPECT_NEAR(result.impulse[1], -mu * result.impulse[0], 1e-14);
  EXPECT_GT(result.velocity[1], 0);
}

TEST(FrozenPhase, ParticleSticksWithinTheImpact) {
  FrozenProblem problem;  // m = 1, μ = 0.5: slip ends at τ = 2, the impact at τ = 10
  problem.resize(1, 1);
  problem.delassus(0, 0) = problem.delassus(1, 1) = 1;
  problem.owner[0] = 0;
  problem.friction[0] = 0.5;
  problem.normalVelocity[0] = -10;
  problem.slipVelocity[0] = 1;
  FrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  EXPECT_DOUBLE_EQ(result.duration, 10);
  EXPECT_EQ(result.velocity[1], 0.0);
  EXPECT_DOUBLE_EQ(result.impulse[1], -1);
  ASSERT_EQ(phase.breakpoints().size(), 3u);
  EXPECT_EQ(phase.breakpoints()[1].event, FrozenEvent::Stick);
  EXPECT_DOUBLE_EQ(phase.breakpoints()[1].tau, 2);
  EXPECT_EQ(phase.breakpoints()[1].force[1], 0.0);
}

TEST(FrozenPhase, PainleveRodOfTheTheory) {
  const double psi = pi / 3;
  const auto rod = body(1, 1.0 / 32, psi, {{-0.5, 0}}, 1);
  const Eigen::Vector3d v(-10, 0, 0);
  FrozenProblem problem = frozen(rod, v, {0});
  problem.normalVelocity[0] = 0;
  const double Ds = problem.delassus(0, 0) + problem.delassus(0, 1);
  ASSERT_LT(Ds, 0);
  FrozenPhase phase;
  const FrozenResult &result = phase.run(problem, 0);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_NEAR(result.impulse[0], 3.849001794598, 1e-12);
  EXPECT_NEAR(result.impulse[1], 3.333333333333, 1e-12);
  const Eigen::VectorXd after = velocityAfter(rod, v, {0}, result.impulse);
  EXPECT_NEAR(after(0), -6.666666666667, 1e-12);
  EXPECT_NEAR(after(1), 3.849001794598, 1e-12);
  EXPECT_NEAR(after(2), 15.396007178391, 1e-12);
  EXPECT_NEAR(after.dot(rod.mass * after) / v.dot(rod.mass * v) - 1, -1.0 / 3, 1e-12);  // a third of the energy is lost
  EXPECT_EQ(result.velocity[0], 0.0);
  // Stick, as |D_nt| ≤ μ D_tt there.
  ASSERT_EQ(phase.breakpoints().size(), 3u);
  EXPECT_EQ(phase.breakpoints()[1].event, FrozenEvent::Stick);
  EXPECT_LT(phase.breakpoints()[1].velocity[0], 0);
}

// D_s = 0: the gap rate stays zero while the impulse ends the slip.
TEST(FrozenPhase, JammedContactLosesItsSlip) {
  for (const double rounding : {0.0, 1e-10, -1e-10}) {
    FrozenProblem problem;
    problem.resize(1, 1);
    problem.delassus.map() << 1 + rounding, 0.5, 0.5, 1;
    problem.owner[0] = 0;
    problem.friction[0] = 2;
    problem.slipVelocity[0] = 1;
    FrozenPhase phase;
    const FrozenResult &result = phase.run(problem, 0);
    EXPECT_EQ(result.status, FrozenStatus::Finished);
    EXPECT_NEAR(result.impulse[0], 2.0 / 3, 1e-9);
    EXPECT_NEAR(result.impulse[1], -4.0 / 3, 1e-9);
    EXPECT_EQ(result.velocity[0], 0.0);
    EXPECT_EQ(result.velocity[1], 0.0);
  }
}

TEST(FrozenPhase, ForcedContactThatIsNotPressedInDoesNothing) {
  FrozenProblem problem;
  problem.resize(1, 0);
  problem.delassus(0, 0) = 1;
  FrozenPhase phase;
  const FrozenResult &result = phase.run(problem, 0);
  EXPECT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_EQ(result.duration, 0.0);
}

TEST(FrozenPhase, ContactHeldBetweenTwoOthersPushesInPart) {
  // Three carts in a row; the middle of three equal contacts (cart 2 against 3, etc.): contact rows v2 − v1 and v3 − v2.
  Eigen::MatrixXd J(2, 3);
  J << -1, 1, 0, 0, -1, 1;
  FrozenProblem problem;
  problem.resize(2, 0);
  problem.delassus.map() = J * J.transpose();  // [2 −1; −1 2]
  problem.normalVelocity = {-1, 0};
  FrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  // Contact 2 is held closed with push ½ while contact 1 pushes: all carts end with the velocity 1/3.
  EXPECT_EQ(result.velocity[0], 0.0);
  EXPECT_EQ(result.velocity[1], 0.0);
  EXPECT_NEAR(result.impulse[0], 2.0 / 3, 1e-15);
  EXPECT_NEAR(result.impulse[1], 1.0 / 3, 1e-15);
  EXPECT_NEAR(phase.breakpoints()[0].force[1], 0.5, 1e-15);
}

TEST(FrozenPhase, ResultsDoNotDependOnACommonFactorOfTheRates) {
  const auto box = body(1, 1.36 / 12, 0.0, {{-0.5, -0.3}, {0.5, -0.3}}, 0.4);
  FrozenPhase phase, scaledPhase;
  for (const double factor : {1.0, 10.0, 1000.0}) {
    const Eigen::Vector3d v(1, -2, 1.5);
    FrozenProblem problem = frozen(box, v, {0, 1});
    problem.rate = {1, 2};
    FrozenProblem scaled = problem;
    scaled.rate = {factor, 2 * factor};
    const FrozenResult &a = phase.run(problem);
    const FrozenResult &b = scaledPhase.run(scaled);
    for (int r = 0; r < 4; ++r) {
      EXPECT_NEAR(a.impulse[r], b.impulse[r], 1e-14);
      EXPECT_NEAR(a.velocity[r], b.velocity[r], 1e-14);
    }
    EXPECT_NEAR(a.duration, factor * b.duration, 1e-13);
  }
}

TEST(FrozenPhase, ClosingWallsAreAnError) {
  FrozenProblem problem;  // a particle between two walls that approach each other
  problem.resize(2, 0);
  problem.delassus.map() << 1, -1, -1, 1;
  problem.normalVelocity = {-1, -0.5};
  FrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  EXPECT_EQ(result.status, FrozenStatus::Unbounded);
  EXPECT_EQ(result.rows, (std::vector<int>{0, 1}));
}

// An impact of 20 discs with 30 contacts that falls on a pile: velocities, and the lower triangle of D where it is not zero.
FrozenProblem pressedDiscs() {
  constexpr int contacts = 30;
  FrozenProblem problem;
  problem.resize(contacts, contacts);
  std::ifstream file(TF_SOURCE_DIR "/tests/unit/runtime/contact/pressed_discs.txt");
  for (std::vector<double> *velocities : {&problem.normalVelocity, &problem.slipVelocity})
    for (double &velocity : *velocities)
      file >> velocity;
  int row = 0, column = 0;
  for (double entry = 0; file >> row >> column >> entry;)
    problem.delassus(row, column) = problem.delassus(column, row) = entry;
  for (int i = 0; i < contacts; ++i) {
    problem.owner[i] = i;
    problem.friction[i] = 0.4;
    problem.restitution[i] = 0.3;
  }
  return problem;
}

// While one contact presses for long, others chatter without a cycle that repeats, as small as they like.
TEST(FrozenPhase, ChatterOfContactsWithRestitutionEnds) {
  const FrozenProblem problem = pressedDiscs();
  FrozenPhase phase;
  const FrozenResult &result = phase.run(problem);
  ASSERT_EQ(result.status, FrozenStatus::Finished);
  EXPECT_LT(result.breakpointCount, 20000);
  double worst = 0, least = 0;
  for (int r = 0; r < problem.count(); ++r) {
    double velocity = r < problem.normalCount ? problem.normalVelocity[r] : problem.slipVelocity[r - problem.normalCount];
    for (int c = 0; c < problem.count(); ++c)
      velocity += problem.delassus(r, c) * result.impulse[c];
    worst = std::max(worst, std::abs(velocity - result.velocity[r]));
    least = std::min(least, r < problem.normalCount ? std::min(result.velocity[r], result.impulse[r]) : 0.0);
  }
  EXPECT_LT(worst, 1e-9);
  EXPECT_EQ(least, 0);
}

TEST(FrozenPhase, NoApproachNoImpact) {
  FrozenProblem problem;
  problem.resize(1, 0);
  problem.delassus(0, 0) = 1;
  problem.normalVelocity[0] = 0.5;
  FrozenPhase phase;
  EXPECT_EQ(phase.run(problem).duration, 0.0);
  EXPECT_EQ(phase.run(problem).velocity[0], 0.5);
}

}  // namespace
}  // namespace tf::runtime
