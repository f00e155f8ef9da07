// Degenerate decisions against the problem a short time later, where nothing is degenerate any more.
#include "runtime/contact/contact_solver.h"

#include "tests/unit/runtime/contact/random_contacts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tf::runtime {
namespace {

using test::RandomContacts;

struct DegenerateProblem {
  ContactProblem problem;
  ContactRates rates;
};

// φ = w − D λ of forces and accelerations chosen such that many rows are on the edge of two modes.
DegenerateProblem degenerateProblem(RandomContacts &contacts, int n, int nv, double largestFriction) {
  DegenerateProblem result;
  ContactProblem &problem = result.problem;
  problem = contacts.problem(n, 1, nv, largestFriction, 0.3);
  Eigen::VectorXd force(problem.count()), acceleration = Eigen::VectorXd::Zero(problem.count());
  for (int i = 0; i < n; ++i) {
    const int kind = contacts.integer(0, 3);  // closed twice as often
    force(i) = kind <= 1 ? contacts.uniform(1, 3) : 0.0;
    acceleration(i) = kind == 2 ? contacts.uniform(1, 3) : 0.0;
  }
  for (int j = 0; j < problem.tangentCount; ++j) {
    const double limit = problem.owner[j] >= 0 ? problem.friction[j] * force(problem.owner[j]) : problem.bound[j];
    const int kind = contacts.integer(0, 3), side = contacts.integer(0, 1) ? 1 : -1;
    if (problem.slipSign[j] != 0) {
      force(n + j) = -problem.slipSign[j] * limit;
      acceleration(n + j) = contacts.uniform(-2, 2);
    } else if (kind == 0) {
      force(n + j) = -side * limit;
      acceleration(n + j) = side * contacts.uniform(1, 2);
    } else {
      force(n + j) = kind == 1 ? contacts.uniform(-0.8, 0.8) * limit : side * limit;
    }
  }
  const Eigen::VectorXd bias = acceleration - problem.delassus.map() * force;
  for (int r = 0; r < problem.count(); ++r)
    problem.bias[r] = bias(r);
  result.rates.resize(n, problem.tangentCount);
  for (double &rate : result.rates.accelerationRate)
    rate = contacts.uniform(-1, 1);
  for (double &rate : result.rates.frictionRate)
    rate = contacts.uniform(-0.02, 0.02);
  for (double &rate : result.rates.boundRate)
    rate = contacts.uniform(-0.2, 0.2);
  return result;
}

ContactProblem later(const DegenerateProblem &at, double h) {
  ContactProblem problem = at.problem;
  for (int r = 0; r < problem.count(); ++r)
    problem.bias[r] += h * at.rates.accelerationRate[r];
  for (int j = 0; j < problem.tangentCount; ++j) {
    problem.friction[j] = std::max(problem.friction[j] + h * at.rates.frictionRate[j], 0.0);
    problem.bound[j] += h * at.rates.boundRate[j];
  }
  return problem;
}

void expectSameMode(const ContactProblem &problem, const ContactMode &decided, const ContactMode &reached, int run) {
  ASSERT_EQ(decided.closed, reached.closed) << "run " << run;
  for (int j = 0; j < problem.tangentCount; ++j) {
    if (problem.owner[j] < 0 || decided.closed[problem.owner[j]]) {
      ASSERT_EQ(decided.slip[j], reached.slip[j]) << "run " << run << " row " << j;
    }
  }
}

void compare(unsigned seed, int fewest, int most, int runs, double friction) {
  RandomContacts contacts(seed);
  ContactSolver solver, reference;
  int degenerate = 0;
  for (int run = 0; run < runs; ++run) {
    const int n = contacts.integer(fewest, most);
    const DegenerateProblem at = degenerateProblem(contacts, n, 4 * n + 4, friction);
    const ContactSolution found = solver.solve(at.problem);
    ASSERT_EQ(found.status, ContactStatus::Solved) << "run " << run;
    const ContactSolution decided = solver.resolve(at.problem, found, at.rates);
    ASSERT_EQ(decided.status, ContactStatus::Solved) << "run " << run;
    const ContactSolution &reached = reference.solve(later(at, 1e-5));
    ASSERT_EQ(reached.status, ContactStatus::Solved) << "run " << run;
    if (!decided.degenerate.empty() || !reached.degenerate.empty())
      continue;  // a rate that is close to zero
    degenerate += found.degenerate.empty() ? 0 : 1;
    expectSameMode(at.problem, decided.mode, reached.mode, run);
    for (int r = 0; r < at.problem.count(); ++r)
      ASSERT_NEAR(solver.forceRates()[r], (reached.forces[r] - found.forces[r]) / 1e-5, 1e-2) << "run " << run << " row " << r;
  }
  EXPECT_GT(degenerate, runs / 3);
}

TEST(NextDerivative, DecidesAsTheProblemShortlyAfter) { compare(51, 1, 3, 1000, 0.4); }

TEST(NextDerivative, DecidesManyRowsByPivoting) { compare(52, 6, 12, 200, 0.2); }

}  // namespace
}  // namespace tf::runtime
