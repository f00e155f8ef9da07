// What runs inside a simulation allocates nothing once it has seen its sizes.
#include "runtime/contact/contact_solver.h"
#include "runtime/contact/frozen_phase.h"
#include "runtime/contact/mode_forces.h"
#include "tests/unit/runtime/allocation_counter.h"
#include "tests/unit/runtime/contact/mechanisms.h"
#include "tests/unit/runtime/contact/random_contacts.h"

#include <gtest/gtest.h>

namespace tf::runtime {
namespace {

template <typename Work> long allocationsOf(const Work &work) {
  work();  // sizes are seen
  const long before = test::allocations;
  work();
  return test::allocations - before;
}

TEST(Allocation, CountsWhatIsAllocated) {
  EXPECT_GT(allocationsOf([] { std::vector<double> values(100); }), 0);
}

TEST(Allocation, NoneInSolversAndForces) {
  test::RandomContacts contacts(61);
  std::vector<ContactProblem> problems;
  for (int k = 0; k < 12; ++k)
    problems.push_back(contacts.problem(1 + k % 6, k % 2, 3 + 2 * k, 0.4, k % 3 * 0.5));
  ContactSolver solver;
  ModeForces forces;
  ContactRates rates;
  std::vector<ContactMode> modes;
  for (const ContactProblem &problem : problems)
    modes.push_back(solver.solve(problem).mode);
  EXPECT_EQ(allocationsOf([&] {
              for (std::size_t k = 0; k < problems.size(); ++k) {
                const ContactProblem &problem = problems[k];
                const ContactSolution &solution = solver.solve(problem, &modes[k]);
                rates.resize(problem.normalCount, problem.tangentCount);
                solver.resolve(problem, solution, rates, &modes[k]);
                forces.start(problem, modes[k]);
                forces.evaluate(problem);
              }
            }),
            0);
}

TEST(Allocation, NoneInFrozenPhases) {
  const auto box = test::body(1, 0.1, 0.0, {{-0.5, -0.3}, {0.5, -0.3}}, 0.4);
  const FrozenProblem problem = test::frozen(box, Eigen::Vector3d(1, -2, 1.5), {0, 1});
  FrozenPhase phase;
  EXPECT_EQ(allocationsOf([&] { phase.run(problem); }), 0);
}

}  // namespace
}  // namespace tf::runtime
