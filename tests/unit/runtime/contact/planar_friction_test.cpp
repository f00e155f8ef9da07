#include "runtime/contact/planar_friction.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>
#include <initializer_list>
#include <random>

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

// Where all rows that are wrong move at once the modes go round in a circle in every third of these problems; one row at a time leads out.
TEST(PlanarFriction, ActiveSetsHardlyEverNeedPivoting) {
  constexpr int problems = 200, contacts = 12, velocities = 30;
  int pivoted = 0;
  for (unsigned seed = 0; seed < problems; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&random](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
    const Eigen::MatrixXd rows = Eigen::MatrixXd::NullaryExpr(2 * contacts, velocities, [&] { return uniform(-1, 1); });
    const Eigen::VectorXd force = Eigen::VectorXd::NullaryExpr(velocities, [&] { return uniform(-1, 1); });
    PlanarFrictionSolver solver;
    PlanarFrictionProblem &problem = solver.problem();
    problem.resize(contacts, contacts);
    for (int i = 0; i < contacts; ++i) {
      problem.tangentKind[i] = TangentKind::TwoSided;
      problem.owner[i] = i;
      problem.friction[i] = uniform(0.1, 0.8);
    }
    problem.delassus.map() = rows * rows.transpose();
    const Eigen::VectorXd bias = rows * force;
    problem.bias.assign(bias.begin(), bias.end());
    const PlanarFrictionSolution &found = solver.solve(nullptr, 1e-9);
    ASSERT_EQ(found.status, PlanarFrictionSolution::Status::Solved) << seed;
    EXPECT_LE(found.violation, 1e-9) << seed;
    const Eigen::Map<const Eigen::VectorXd> forces(found.force.data(), 2 * contacts);
    for (int i = 0; i < contacts; ++i) {
      EXPECT_GE(forces[i], -1e-9) << seed << ' ' << i;
      EXPECT_LE(std::abs(forces[contacts + i]), problem.friction[i] * forces[i] + 1e-9) << seed << ' ' << i;
      EXPECT_GE((rows * (rows.transpose() * forces + force))[i], -1e-8) << seed << ' ' << i;
    }
    pivoted += solver.path() == PlanarFrictionSolver::Path::Pivoting ? 1 : 0;
  }
  EXPECT_LE(pivoted, problems / 20);
}

// A body of unit mass and inertia on a floor, with contacts at these places, the floor's height below the centre; slips are zero. The
// force f acts on it.
void placeOnFloor(PlanarFrictionProblem &problem, std::initializer_list<double> places, double height, double friction,
                  const Eigen::Vector3d &force) {
  const int n = static_cast<int>(places.size());
  Eigen::MatrixXd rows(2 * n, 3);
  problem.resize(n, n);
  for (int i = 0; i < n; ++i) {
    rows.row(i) << 0, 1, places.begin()[i];
    rows.row(n + i) << 1, 0, height;
    problem.tangentKind[i] = TangentKind::TwoSided;
    problem.owner[i] = i;
    problem.friction[i] = friction;
  }
  problem.delassus.map() = rows * rows.transpose();
  const Eigen::VectorXd bias = rows * force;
  problem.bias.assign(bias.begin(), bias.end());
}

using Wanted = PlanarFrictionSolver::Wanted;
using Status = PlanarFrictionSolution::Status;

// Two contacts of one body share their friction in many ways, but the body moves in one: the first mode that has it will do.
TEST(PlanarFriction, AccelerationsOfSmallFrictionAreThoseOfAllModes) {
  std::mt19937 random(5);
  const auto uniform = [&random](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  PlanarFrictionSolver all, first;
  int different = 0;
  for (int run = 0; run < 2000; ++run) {
    const double height = uniform(0, 1.5), friction = uniform(0, 0.6), left = uniform(-2, -0.1), right = uniform(0.1, 2);
    const Eigen::Vector3d force(uniform(-3, 3), uniform(-10, 2), uniform(-3, 3));
    for (PlanarFrictionSolver *solver : {&all, &first})
      placeOnFloor(solver->problem(), {left, right}, height, friction, force);
    PlanarFrictionMode previous;
    previous.normal.assign(2, NormalState::Active);
    previous.slip.assign(2, static_cast<std::int8_t>(run % 3 - 1));
    const PlanarFrictionSolution &a = all.solve(&previous, 1e-10, Wanted::Forces);
    const PlanarFrictionSolution &b = first.solve(&previous, 1e-10, Wanted::Accelerations);
    ASSERT_EQ(a.status, b.status) << "run " << run;
    if (a.status != Status::Solved)
      continue;
    ASSERT_LE(b.violation, 1e-10);
    for (int r = 0; r < 4; ++r) {
      ASSERT_NEAR(a.acceleration[r], b.acceleration[r], 1e-9) << "run " << run << ", row " << r;
      different += std::abs(a.force[r] - b.force[r]) > 1e-6 ? 1 : 0;
    }
  }
  EXPECT_GT(different, 0);
}

// With much friction slips press their contacts in (D_s < 0): several solutions, or none, and both are seen.
TEST(PlanarFriction, SeveralAccelerationsOfMuchFrictionAreFound) {
  PlanarFrictionSolver solver;
  int several = 0, none = 0;
  for (const double force : {-1.0, 1.0}) {
    PlanarFrictionProblem &problem = solver.problem();
    placeOnFloor(problem, {1, -0.2}, -2, 3, {0, force, 0});
    problem.tangentKind[0] = problem.tangentKind[1] = TangentKind::Slip;
    problem.sign[0] = problem.sign[1] = -1;
    const Status status = solver.solve(nullptr, 1e-10, Wanted::Accelerations).status;
    several += status == Status::Several ? 1 : 0;
    none += status == Status::None ? 1 : 0;
  }
  EXPECT_EQ(several, 1);
  EXPECT_EQ(none, 1);
}

}  // namespace
}  // namespace tf::runtime
