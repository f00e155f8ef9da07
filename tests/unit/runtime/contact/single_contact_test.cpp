#include "runtime/contact/single_contact.h"

#include "runtime/contact/contact_solver.h"
#include "tests/unit/runtime/contact/random_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tf::runtime {
namespace {

constexpr double degeneracy = 1e-9;

// D = [1 c; c 1].
ContactProblem contact(double c, double mu, double normal, double tangential, int slipSign) {
  ContactProblem problem;
  problem.resize(1, 1);
  problem.delassus(0, 0) = problem.delassus(1, 1) = 1;
  problem.delassus(0, 1) = problem.delassus(1, 0) = c;
  problem.bias = {normal, tangential};
  problem.owner[0] = 0;
  problem.friction[0] = mu;
  problem.slipSign[0] = slipSign;
  return problem;
}

bool solves(const ContactProblem &problem) {
  ContactSolution solution;
  return solveSingleContact(problem, degeneracy, solution);
}

// What is solved meets the conditions, and most problems are.
TEST(SingleContact, MeetsTheConditions) {
  test::RandomContacts random(11);
  int solved = 0, modes[4] = {};
  constexpr int runs = 4000;
  for (int run = 0; run < runs; ++run) {
    const ContactProblem problem = random.problem(1, 0, 3, 1.5, 0.4);
    ContactSolution solution;
    if (!solveSingleContact(problem, degeneracy, solution))
      continue;
    ++solved;
    const double scale = 1 + std::max(std::abs(problem.bias[0]), std::abs(problem.bias[1])) + std::abs(solution.forces[0]);
    ASSERT_LE(test::violationOf(problem, solution.forces), 1e-13 * scale) << "run " << run;
    ASSERT_LE(solution.violation, 1e-14);
    for (int r = 0; r < 2; ++r) {
      const double w = problem.delassus(r, 0) * solution.forces[0] + problem.delassus(r, 1) * solution.forces[1] + problem.bias[r];
      ASSERT_NEAR(solution.accelerations[r], w, 1e-13 * scale);
    }
    ++modes[solution.mode.closed[0] == 0 ? 3 : 1 + solution.mode.slip[0]];
    if (solution.mode.closed[0] != 0 && problem.slipSign[0] != 0) {
      ASSERT_EQ(solution.mode.slip[0], problem.slipSign[0]);
    }
  }
  EXPECT_GT(solved, runs / 2);
  for (const int count : modes)
    EXPECT_GT(count, runs / 50);
}

// The general solver, which a friction element of its own beside the contact calls for, finds the same.
TEST(SingleContact, AgreesWithTheGeneralSolver) {
  test::RandomContacts random(12);
  ContactSolver general;
  for (int run = 0; run < 500; ++run) {
    const ContactProblem problem = random.problem(1, 0, 3, 0.8, 0.4);
    ContactSolution single;
    if (!solveSingleContact(problem, degeneracy, single))
      continue;
    ContactProblem beside;
    beside.resize(1, 2);
    for (int c = 0; c < 2; ++c)
      for (int r = 0; r < 2; ++r)
        beside.delassus(r, c) = problem.delassus(r, c);
    beside.delassus(2, 2) = beside.bound[1] = 1;
    beside.bias[0] = problem.bias[0];
    beside.bias[1] = problem.bias[1];
    beside.owner[0] = 0;
    beside.friction[0] = problem.friction[0];
    beside.slipSign[0] = problem.slipSign[0];
    const ContactSolution &both = general.solve(beside);
    ASSERT_EQ(both.mode.closed[0], single.mode.closed[0]) << "run " << run;
    if (single.mode.closed[0] != 0) {
      ASSERT_EQ(both.mode.slip[0], single.mode.slip[0]) << "run " << run;
    }
    for (int r = 0; r < 2; ++r)
      ASSERT_NEAR(both.forces[r], single.forces[r], 1e-11 * (1 + std::abs(single.forces[0])));
  }
  EXPECT_EQ(general.statistics().direct, 0);
}

TEST(SingleContact, LeavesWhatIsNotClear) {
  EXPECT_TRUE(solves(contact(0.1, 0.3, -1, 0, 1)));
  // Painlevé: sliding with D_s ≤ 0, and sticking where the other direction of slip would have it.
  EXPECT_FALSE(solves(contact(0.8, 1.3, -1, 0, 1)));
  EXPECT_TRUE(solves(contact(0.8, 1.3, -1, 0, -1)));
  EXPECT_FALSE(solves(contact(0.8, 1.3, -1, 0.2, 0)));
  // Lifted, but one more force would press it down.
  EXPECT_FALSE(solves(contact(0.8, 1.3, 1, 0, 1)));
  // No load; on the border of the cone; a slip that does not start.
  EXPECT_FALSE(solves(contact(0, 0.3, 1e-8, 1, 0)));
  EXPECT_FALSE(solves(contact(0, 0.5, -2, 1 + 1e-8, 0)));
  EXPECT_FALSE(solves(contact(0, 0.5, -2, 1, 0)));
  EXPECT_TRUE(solves(contact(0, 0.5, -2, 1.01, 0)));
  // Rows that depend on each other.
  EXPECT_FALSE(solves(contact(1, 0.5, -2, 0.1, 0)));
}

TEST(SingleContact, WithoutFriction) {
  ContactProblem problem;
  problem.resize(1, 0);
  problem.delassus(0, 0) = 4;
  problem.bias[0] = -2;
  ContactSolution solution;
  ASSERT_TRUE(solveSingleContact(problem, degeneracy, solution));
  EXPECT_EQ(solution.mode.closed[0], 1);
  EXPECT_DOUBLE_EQ(solution.forces[0], 0.5);
  problem.bias[0] = 2;
  ASSERT_TRUE(solveSingleContact(problem, degeneracy, solution));
  EXPECT_EQ(solution.mode.closed[0], 0);
  EXPECT_DOUBLE_EQ(solution.accelerations[0], 2);
  problem.resize(2, 0);
  EXPECT_FALSE(solveSingleContact(problem, degeneracy, solution));
}

}  // namespace
}  // namespace tf::runtime
