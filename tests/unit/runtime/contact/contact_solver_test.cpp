#include "runtime/contact/contact_solver.h"

#include "runtime/contact/mode_forces.h"
#include "tests/unit/runtime/contact/mechanisms.h"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace tf::runtime {
namespace {

using test::accelerationProblem;
using test::body;
using test::chain;

constexpr double gravity = 9.81;

// A particle of mass 1 on a floor: D = I.
ContactProblem particle(double mu, double normal, double tangential, int slipSign) {
  ContactProblem problem;
  problem.resize(1, 1);
  problem.delassus(0, 0) = problem.delassus(1, 1) = 1;
  problem.bias = {normal, tangential};
  problem.owner[0] = 0;
  problem.friction[0] = mu;
  problem.slipSign[0] = slipSign;
  return problem;
}

Eigen::VectorXd freeAccelerations(const test::Mechanism &mechanism, const Eigen::VectorXd &force) {
  return mechanism.jacobian() * mechanism.mass.ldlt().solve(force);
}

TEST(ContactSolver, ParticleSlidesSticksStartsAndOpens) {
  ContactSolver solver;
  const ContactSolution &slides = solver.solve(particle(0.3, -gravity, 0, 1));
  EXPECT_EQ(slides.status, ContactStatus::Solved);
  EXPECT_EQ(slides.mode.closed[0], 1);
  EXPECT_EQ(slides.mode.slip[0], 1);
  EXPECT_DOUBLE_EQ(slides.forces[0], gravity);
  EXPECT_DOUBLE_EQ(slides.forces[1], -0.3 * gravity);

  const ContactSolution &sticks = solver.solve(particle(0.3, -gravity, 2, 0));
  EXPECT_EQ(sticks.mode.slip[0], 0);
  EXPECT_DOUBLE_EQ(sticks.forces[1], -2);
  EXPECT_EQ(sticks.accelerations[1], 0.0);
  EXPECT_TRUE(sticks.degenerate.empty());

  const ContactSolution &starts = solver.solve(particle(0.3, -gravity, -4, 0));
  EXPECT_EQ(starts.mode.slip[0], -1);
  EXPECT_DOUBLE_EQ(starts.forces[1], 0.3 * gravity);
  EXPECT_NEAR(starts.accelerations[1], -4 + 0.3 * gravity, 1e-15);

  const ContactSolution &opens = solver.solve(particle(0.3, 1, -4, 0));
  EXPECT_EQ(opens.mode.closed[0], 0);
  EXPECT_EQ(opens.forces[1], 0.0);
}

TEST(ContactSolver, FrictionElementWithoutContact) {
  ContactProblem problem;
  problem.resize(0, 1);
  problem.delassus(0, 0) = 2;
  problem.bias[0] = 3;
  problem.bound[0] = 1;
  ContactSolver solver;
  EXPECT_EQ(solver.solve(problem).mode.slip[0], 1);
  EXPECT_DOUBLE_EQ(solver.solve(problem).accelerations[0], 1);
  problem.bound[0] = 2;
  EXPECT_EQ(solver.solve(problem).mode.slip[0], 0);
  EXPECT_DOUBLE_EQ(solver.solve(problem).forces[0], -1.5);
}

// theory.md section 3: the rod at 60° with μ = 1 has D_s < 0. Gravity presses it down: no solution. Lifted: two.
TEST(ContactSolver, PainleveRod) {
  const auto rod = body(1, 1.0 / 32, std::numbers::pi / 3, {{-0.5, 0}}, 1);
  ContactSolver solver;
  const Eigen::VectorXd pressed = freeAccelerations(rod, Eigen::Vector3d(0, -gravity, 0));
  const ContactSolution &none = solver.solve(accelerationProblem(rod, pressed, {-1}));
  EXPECT_EQ(none.status, ContactStatus::Inconsistent);
  EXPECT_EQ(none.forced, 0);

  const ContactProblem lifted = accelerationProblem(rod, -pressed, {-1});
  const ContactSolution &two = solver.solve(lifted);
  EXPECT_EQ(two.status, ContactStatus::Indeterminate);
  EXPECT_EQ(two.mode.closed[0], 0);
  EXPECT_EQ(two.forces[0], 0.0);
  // Not even when it was closed before: D_s < 0 is no balance that lasts.
  ContactMode closed;
  closed.resize(1, 1);
  closed.closed[0] = 1;
  closed.slip[0] = -1;
  EXPECT_EQ(solver.solve(lifted, &closed).mode.closed[0], 0);
  // In the other direction it slides as usual.
  EXPECT_EQ(solver.solve(accelerationProblem(rod, pressed, {1})).status, ContactStatus::Solved);
}

TEST(ContactSolver, BoxAtRestOnTwoCornersTakesTheLeastNormForce) {
  const auto box = body(2, 0.3, 0, {{-0.5, -0.3}, {0.5, -0.3}}, 0.5);
  ContactSolver solver;
  // A horizontal push F at height h above the floor: normal forces by the moments, friction shared so that the norm is least: equally.
  const double push = 4, height = 0.3;  // at the centre of mass
  const ContactProblem problem = accelerationProblem(box, freeAccelerations(box, Eigen::Vector3d(push, -2 * gravity, 0)), {0, 0});
  const ContactSolution &found = solver.solve(problem);
  ASSERT_EQ(found.status, ContactStatus::Solved);
  EXPECT_TRUE(found.redundant);
  EXPECT_TRUE(found.saturated.empty());
  EXPECT_NEAR(found.forces[0], gravity - push * height, 1e-12);
  EXPECT_NEAR(found.forces[1], gravity + push * height, 1e-12);
  EXPECT_NEAR(found.forces[2], -push / 2, 1e-12);
  EXPECT_NEAR(found.forces[3], -push / 2, 1e-12);
  EXPECT_TRUE(found.degenerate.empty());
  EXPECT_LT(found.violation, 1e-12);
}

TEST(ContactSolver, LeastNormForceOnTheConeOfTheUnloadedCorner) {
  const auto box = body(2, 0.3, 0, {{-0.5, -0.3}, {0.5, -0.3}}, 0.5);
  ContactSolver solver;
  // Pushed so high that the left corner carries 2 only: its half of the push, 4, exceeds its cone, 1. The right corner takes the rest.
  const double push = 8, moment = -(gravity - 2) + 0.3 * push;
  const ContactProblem problem = accelerationProblem(box, freeAccelerations(box, Eigen::Vector3d(push, -2 * gravity, moment)), {0, 0});
  const ContactSolution &found = solver.solve(problem);
  ASSERT_EQ(found.status, ContactStatus::Solved);
  ASSERT_NEAR(found.forces[0], 2, 1e-12);
  EXPECT_NEAR(found.forces[2], -1, 1e-12);
  EXPECT_NEAR(found.forces[3], -7, 1e-12);
  ASSERT_EQ(found.saturated.size(), 1u);
  EXPECT_EQ(found.saturated[0], (ForceLimit{2, -1}));
  // The cone is touched by the representative only: nothing is to be decided.
  EXPECT_TRUE(found.degenerate.empty());
}

TEST(ContactSolver, SimultaneouslyUnloadedCornersOpenAsOne) {
  const auto box = body(1, 0.1, 0, {{-0.5, -0.3}, {0.5, -0.3}}, 0.5);
  ContactSolver solver;
  const Eigen::Vector3d weightless(0, 0, 0), lift(0, 1, 0);
  const ContactProblem problem = accelerationProblem(box, freeAccelerations(box, weightless), {1, 1});
  ContactMode previous;
  previous.resize(2, 2);
  previous.closed = {1, 1};
  previous.slip = {1, 1};
  const ContactSolution found = solver.solve(problem, &previous);
  ASSERT_EQ(found.degenerate, (std::vector<int>{0, 1}));
  ContactRates rates;
  rates.resize(2, 2);
  const Eigen::VectorXd rise = freeAccelerations(box, lift);
  for (int r = 0; r < 4; ++r)
    rates.accelerationRate[r] = rise(r);
  EXPECT_EQ(solver.resolve(problem, found, rates, &previous).mode.closed, (std::vector<std::uint8_t>{0, 0}));
  for (int r = 0; r < 4; ++r)
    rates.accelerationRate[r] = -rise(r);
  EXPECT_EQ(solver.resolve(problem, found, rates, &previous).mode.closed, (std::vector<std::uint8_t>{1, 1}));
  // Tilting: the left one opens, the right one stays.
  const Eigen::VectorXd tilt = freeAccelerations(box, Eigen::Vector3d(0, 0, -1));
  for (int r = 0; r < 4; ++r)
    rates.accelerationRate[r] = tilt(r);
  EXPECT_EQ(solver.resolve(problem, found, rates, &previous).mode.closed, (std::vector<std::uint8_t>{0, 1}));
  // Nothing known: as before.
  rates.resize(2, 2);
  const ContactSolution &undecided = solver.resolve(problem, found, rates, &previous);
  EXPECT_EQ(undecided.mode.closed, (std::vector<std::uint8_t>{1, 1}));
  EXPECT_EQ(undecided.degenerate.size(), 2u);
}

TEST(ContactSolver, ForceAtTheLimitOfFrictionIsDecidedByItsRate) {
  ContactSolver solver;
  const ContactProblem problem = particle(0.5, -10, 5, 0);  // λ_t = −5 = −limit, w_t = 0
  ContactMode sticking;
  sticking.resize(1, 1);
  sticking.closed[0] = 1;
  const ContactSolution found = solver.solve(problem, &sticking);
  ASSERT_EQ(found.degenerate, std::vector<int>{1});
  EXPECT_EQ(found.mode.slip[0], 0);
  ContactRates rates;
  rates.resize(1, 1);
  rates.accelerationRate = {0, 1};  // pulled harder: it slips along the pull
  const ContactSolution &slips = solver.resolve(problem, found, rates, &sticking);
  EXPECT_EQ(slips.mode.slip[0], 1);
  EXPECT_TRUE(slips.degenerate.empty());
  rates.accelerationRate = {0, -1};
  EXPECT_EQ(solver.resolve(problem, found, rates, &sticking).mode.slip[0], 0);
  EXPECT_DOUBLE_EQ(solver.forceRates()[1], 1);
  rates.accelerationRate = {-1, 0.4};  // pressed harder too: the limit grows faster than the pull
  EXPECT_EQ(solver.resolve(problem, found, rates, &sticking).mode.slip[0], 0);
  rates.accelerationRate = {-1, 0.6};
  EXPECT_EQ(solver.resolve(problem, found, rates, &sticking).mode.slip[0], 1);
  rates.accelerationRate = {0, 0};
  rates.frictionRate = {-0.1};
  EXPECT_EQ(solver.resolve(problem, found, rates, &sticking).mode.slip[0], 1);
}

// All corners of a redundant support reach their cones at once: the set of forces is one point, and the next derivative decides.
TEST(ContactSolver, RedundantStickEndsWhenTheSetIsEmpty) {
  const auto box = body(1, 0.1, 0, {{-0.5, -0.3}, {0.5, -0.3}}, 0.5);
  ContactSolver solver;
  const ContactProblem problem = accelerationProblem(box, freeAccelerations(box, Eigen::Vector3d(0.5 * gravity, -gravity, 0)), {0, 0});
  const ContactSolution found = solver.solve(problem);
  ASSERT_TRUE(found.redundant);
  ASSERT_EQ(found.degenerate, (std::vector<int>{2, 3}));
  ContactRates rates;
  rates.resize(2, 2);
  const Eigen::VectorXd pull = freeAccelerations(box, Eigen::Vector3d(1, 0, 0));
  for (int r = 0; r < 4; ++r)
    rates.accelerationRate[r] = pull(r);
  EXPECT_EQ(solver.resolve(problem, found, rates).mode.slip, (std::vector<std::int8_t>{1, 1}));
  for (int r = 0; r < 4; ++r)
    rates.accelerationRate[r] = -pull(r);
  EXPECT_EQ(solver.resolve(problem, found, rates).mode.slip, (std::vector<std::int8_t>{0, 0}));
}

TEST(ContactSolver, ChainAtRestOnFourNodes) {
  const auto links = chain({0, 0, 0}, 1.0 / 3, 1.0 / 3, 0.5);
  Eigen::VectorXd weight(5);
  weight << 0, -gravity, -gravity * (1.0 / 18 + 2.0 / 9), -gravity * (1.0 / 18 + 1.0 / 9), -gravity / 18;
  ContactSolver solver;
  const ContactProblem problem = accelerationProblem(links, freeAccelerations(links, weight), {0, 0, 0, 0});
  const ContactSolution &found = solver.solve(problem);
  ASSERT_EQ(found.status, ContactStatus::Solved);
  EXPECT_TRUE(found.redundant);  // four sticking rows along one line, one freedom
  EXPECT_EQ(found.mode.slip, (std::vector<std::int8_t>{0, 0, 0, 0}));
  const double half = gravity / 6;
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(found.forces[i], i == 0 || i == 3 ? half : 2 * half, 1e-11);
    EXPECT_NEAR(found.forces[4 + i], 0, 1e-11);
  }
}

// A body that is pressed on redundant contacts, and another one in free fall between two contacts that hardly open: to hold these too would
// take pulling forces, larger than what passes for zero.
TEST(ContactSolver, IdleContactsDoNotPull) {
  ContactProblem problem;
  problem.resize(4, 0);
  problem.delassus(0, 0) = problem.delassus(0, 1) = problem.delassus(1, 0) = problem.delassus(1, 1) = 1;
  problem.delassus(2, 2) = problem.delassus(3, 3) = 1;
  problem.delassus(2, 3) = problem.delassus(3, 2) = 0.999;
  problem.bias = {-10, -10, 9e-9, 1e-9};
  ContactSolver solver;
  const ContactSolution &solution = solver.solve(problem);
  EXPECT_EQ(solution.status, ContactStatus::Solved);
  EXPECT_NEAR(solution.forces[0], 5, 1e-12);
  EXPECT_NEAR(solution.forces[1], 5, 1e-12);
  EXPECT_NEAR(solution.forces[2], 0, 1e-8);
  EXPECT_NEAR(solution.forces[3], 0, 1e-8);
  EXPECT_EQ(solution.mode.closed[0] + solution.mode.closed[1], 2);
  ModeForces forces;
  EXPECT_TRUE(forces.start(problem, solution.mode));
}

// Three sticking rows, two of them equal, along (1, 0), (1, 0), (1, ε): the last one bears more than friction gives, by so little that what
// remains of its acceleration passes for zero. It begins to slip, against its force.
TEST(ContactSolver, StickThatHardlyExceedsItsFrictionSlips) {
  constexpr double lever = 1e-3, limit = 0.25, excess = 2e-7;
  ContactProblem problem;
  problem.resize(0, 3);
  const std::array<double, 3> along = {0, 0, lever}, held = {0.3, 0.45 - excess, limit + excess};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      problem.delassus(r, c) = 1 + along[r] * along[c];
  for (int r = 0; r < 3; ++r) {
    problem.bound[r] = r == 2 ? limit : 1;
    problem.bias[r] = 0;
    for (int c = 0; c < 3; ++c)
      problem.bias[r] -= problem.delassus(r, c) * held[c];
  }
  ContactSolver solver;
  const ContactSolution &solution = solver.solve(problem);
  ASSERT_EQ(solution.status, ContactStatus::Solved);
  EXPECT_EQ(solution.mode.slip, (std::vector<std::int8_t>{0, 0, -1}));
  ModeForces forces;
  EXPECT_TRUE(forces.start(problem, solution.mode));
  EXPECT_DOUBLE_EQ(forces.forces()[2], limit);
}

// The decision and the forces' physical values do not depend on units.
TEST(ContactSolver, DoesNotDependOnUnits) {
  const auto box = body(1, 0.1, 0.3, {{-0.5, -0.3}, {0.5, -0.3}}, 0.5);
  ContactSolver solver;
  const ContactProblem problem = accelerationProblem(box, freeAccelerations(box, Eigen::Vector3d(1, -gravity, 2)), {1, 0});
  const ContactSolution reference = solver.solve(problem);
  for (const double unit : {1e-9, 1e6}) {
    ContactProblem scaled = problem;
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r)
        scaled.delassus(r, c) *= unit;
    const ContactSolution &found = solver.solve(scaled);
    EXPECT_EQ(found.mode, reference.mode);
    for (int r = 0; r < 4; ++r)
      EXPECT_NEAR(found.forces[r] * unit, reference.forces[r], 1e-12);
  }
}

}  // namespace
}  // namespace tf::runtime
