#include "runtime/contact/contact_solver.h"

#include "tests/unit/runtime/contact/random_contacts.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tf::runtime {
namespace {

using test::RandomContacts;
using test::violationOf;

// Every solution of a small problem, by trying all modes with a rank-revealing factorisation; modes with singular equations are skipped,
// their solutions are found as those of other modes.
std::vector<Eigen::VectorXd> allSolutions(const ContactProblem &problem) {
  const int n = problem.normalCount, m = problem.tangentCount, count = n + m;
  std::vector<Eigen::VectorXd> solutions;
  std::vector<int> state(count, 0);  // normal: 0 open, 1 closed; tangent: −1, 0, 1
  int total = 1;
  for (int r = 0; r < count; ++r)
    total *= r < n ? 2 : 3;
  for (int code = 0; code < total; ++code) {
    int rest = code;
    for (int r = 0; r < count; ++r) {
      const int base = r < n ? 2 : 3;
      state[r] = r < n ? rest % base : rest % base - 1;
      rest /= base;
    }
    // Unknown λ (all rows): one equation each.
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(count);
    const auto motionless = [&](int r) {
      A.row(r) = problem.delassus.map().row(r);
      b(r) = -problem.bias[r];
    };
    for (int i = 0; i < n; ++i) {
      if (state[i])
        motionless(i);
      else
        A(i, i) = 1;
    }
    for (int j = 0; j < m; ++j) {
      const int row = n + j, owner = problem.owner[j];
      const int slip = problem.slipSign[j] != 0 ? problem.slipSign[j] : state[row];
      if (slip == 0 && (owner < 0 || state[owner])) {
        motionless(row);
        continue;
      }
      A(row, row) = 1;
      if (owner >= 0)
        A(row, owner) = slip * problem.friction[j];
      else
        b(row) = -slip * problem.bound[j];
    }
    const Eigen::FullPivLU<Eigen::MatrixXd> lu(A);
    if (lu.rank() < count)
      continue;
    const Eigen::VectorXd lambda = lu.solve(b);
    if (violationOf(problem, std::vector<double>(lambda.begin(), lambda.end())) < 1e-9)
      solutions.push_back(lambda);
  }
  return solutions;
}

TEST(ContactSolverRandom, AgreesWithAllModesOfSmallProblems) {
  RandomContacts contacts(11);
  ContactSolver solver;
  int inconsistent = 0, indeterminate = 0, redundant = 0;
  for (int run = 0; run < 3000; ++run) {
    const int n = contacts.integer(1, 3), elements = contacts.integer(0, 1);
    const double slipping = contacts.integer(0, 2) * 0.5;
    const ContactProblem problem = contacts.problem(n, elements, contacts.integer(2, 8), 2, slipping);
    const auto solutions = allSolutions(problem);
    const ContactSolution &found = solver.solve(problem);
    ASSERT_EQ(found.status == ContactStatus::Inconsistent, solutions.empty()) << "run " << run;
    if (solutions.empty()) {
      ++inconsistent;
      ASSERT_GE(found.forced, 0);
      continue;
    }
    indeterminate += found.status == ContactStatus::Indeterminate ? 1 : 0;
    redundant += found.redundant ? 1 : 0;
    ASSERT_LT(violationOf(problem, found.forces), 1e-8) << "run " << run;
    double nearest = 1e300;
    for (const Eigen::VectorXd &lambda : solutions) {
      double distance = 0;
      const Eigen::VectorXd w = problem.delassus.map() * lambda + Eigen::Map<const Eigen::VectorXd>(problem.bias.data(), problem.count());
      for (int r = 0; r < n; ++r)
        distance = std::max(distance, std::abs(w(r) - found.accelerations[r]));
      nearest = std::min(nearest, distance);
    }
    ASSERT_LT(nearest, 1e-7) << "run " << run;
  }
  // The sample must contain all kinds, or it shows nothing.
  EXPECT_GT(inconsistent, 10);
  EXPECT_GT(indeterminate, 10);
  EXPECT_GT(redundant, 50);
}

TEST(ContactSolverRandom, ManyContactsSatisfyTheirConditions) {
  RandomContacts contacts(12);
  ContactSolver solver;
  for (int run = 0; run < 600; ++run) {
    const int n = contacts.integer(4, 20);
    const ContactProblem problem = contacts.problem(n, contacts.integer(0, 2), contacts.integer(3, 60), 2 * contacts.uniform(0, 1), 0);
    const ContactSolution &found = solver.solve(problem);
    ASSERT_NE(found.status, ContactStatus::Inconsistent) << "run " << run;
    ASSERT_LT(found.violation, 1e-9) << "run " << run;
    ASSERT_LT(violationOf(problem, found.forces), 1e-6) << "run " << run;
  }
}

TEST(ContactSolverRandom, WarmStartKeepsTheSolution) {
  RandomContacts contacts(13);
  ContactSolver solver;
  for (int run = 0; run < 200; ++run) {
    const ContactProblem problem = contacts.problem(contacts.integer(1, 12), 0, 40, 0.4, 0.5);
    const ContactSolution first = solver.solve(problem);
    if (first.status != ContactStatus::Solved)
      continue;
    const long kept = solver.statistics().previousModeKept;
    const ContactSolution &second = solver.solve(problem, &first.mode);
    if (problem.normalCount > 6) {
      ASSERT_EQ(solver.statistics().previousModeKept, kept + 1) << "run " << run;
    }
    for (int r = 0; r < problem.count(); ++r)
      ASSERT_NEAR(first.forces[r], second.forces[r], 1e-8) << "run " << run;
  }
}

}  // namespace
}  // namespace tf::runtime
