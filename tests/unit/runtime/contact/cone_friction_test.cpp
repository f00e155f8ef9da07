#include "runtime/contact/cone_friction.h"
#include "runtime/contact/contact_solver.h"
#include "runtime/contact/mode_forces.h"

#include "tests/unit/runtime/contact/spatial_bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace tf::runtime {
namespace {

// All slips are zero; the free acceleration of the body is `acceleration`.
ContactProblem problemOf(const test::SpatialBody &body, double friction, const Eigen::VectorXd &acceleration) {
  const int contacts = static_cast<int>(body.rows.rows()) / 3;
  ContactProblem problem;
  problem.resize(contacts, 2 * contacts);
  problem.delassus.map() = body.rows * body.mass.inverse() * body.rows.transpose();
  Eigen::Map<Eigen::VectorXd>(problem.bias.data(), 3 * contacts) = body.rows * acceleration;
  for (int j = 0; j < 2 * contacts; ++j) {
    problem.owner[j] = j / 2;
    problem.partner[j] = j ^ 1;
    problem.friction[j] = friction;
  }
  return problem;
}

// Signorini's and Coulomb's conditions by forces and accelerations themselves.
double violationOf(const ContactProblem &problem, const ContactSolution &solution) {
  const int n = problem.normalCount;
  double worst = 0;
  for (int i = 0; i < n; ++i) {
    const double force = solution.forces[i], acceleration = solution.accelerations[i];
    const Eigen::Vector2d friction(solution.forces[n + 2 * i], solution.forces[n + 2 * i + 1]);
    const Eigen::Vector2d slip(solution.accelerations[n + 2 * i], solution.accelerations[n + 2 * i + 1]);
    const double limit = problem.friction[2 * i] * force;
    worst = std::max({worst, -force, -acceleration, std::min(force, acceleration), friction.norm() - limit});
    if (slip.norm() > 1e-8)
      worst = std::max(worst, (friction + limit * slip.normalized()).norm());
  }
  return worst;
}

TEST(ConeFriction, RandomBodiesAtRest) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  ContactSolver solver;
  int slips = 0, sticks = 0, open = 0, unsolved = 0;
  for (int run = 0; run < 1000; ++run) {
    const int contacts = 1 + run % 4;
    const test::SpatialBody body = test::spatialBody(generator, contacts);
    Eigen::VectorXd acceleration(6);
    for (double &a : acceleration)
      a = 5 * uniform(generator);
    acceleration[2] -= 5;
    const ContactProblem problem = problemOf(body, 0.5 * (1 + uniform(generator)), acceleration);
    const ContactSolution &solution = solver.solve(problem);
    if (solution.status != ContactStatus::Solved) {
      ++unsolved;
      continue;
    }
    EXPECT_LT(violationOf(problem, solution), 1e-7) << run;
    for (int i = 0; i < contacts; ++i) {
      open += !solution.mode.closed[i];
      slips += solution.mode.closed[i] && solution.mode.slip[2 * i] != 0;
      sticks += solution.mode.closed[i] && solution.mode.slip[2 * i] == 0;
    }
  }
  EXPECT_EQ(unsolved, 0);
  EXPECT_GT(slips, 200);
  EXPECT_GT(sticks, 200);
  EXPECT_GT(open, 200);
}

// A ball on the floor leans against another one: without friction at rest the contact between them has a solution only while it slips, and
// none there, but friction of both can hold them.
TEST(ConeFriction, BallsThatOnlyTheirFrictionHolds) {
  Eigen::MatrixXd D(6, 6);
  D << 3.6253, -0.9047, 0, 0, 3.5016, -0.2525,  //
      -0.9047, 4.1024, 3.5016, -0.2525, 0, 0,   //
      0, 3.5016, 12.6887, 0, -8.1235, 0.4874,   //
      0, -0.2525, 0, 12.6887, 0.4874, -1.3987,  //
      3.5016, 0, -8.1235, 0.4874, 14.3585, 0,   //
      -0.2525, 0, 0.4874, -1.3987, 0, 14.3585;
  ContactProblem problem;
  problem.resize(2, 4);
  problem.delassus.map() = D;
  problem.bias = {-9.81, 2.3391, 0, 0, -1.0834, 7.0704};
  for (int j = 0; j < 4; ++j) {
    problem.owner[j] = j / 2;
    problem.partner[j] = j ^ 1;
    problem.friction[j] = j < 2 ? 1.3248 : 0.9825;
  }
  ContactSolver solver;
  const ContactSolution &solution = solver.solve(problem);
  ASSERT_EQ(solution.status, ContactStatus::Solved);
  EXPECT_LT(violationOf(problem, solution), 1e-9);
  EXPECT_EQ(solution.mode.closed, (std::vector<std::uint8_t>{1, 1}));
  EXPECT_EQ(solution.mode.slip, (std::vector<std::int8_t>{0, 0, 0, 0}));
}

double uniformOf(std::mt19937 &generator) { return 2 * static_cast<double>(generator()) / std::mt19937::max() - 1; }

Eigen::Vector3d directionOf(std::mt19937 &generator) {
  Eigen::Vector3d direction;
  do {
    for (double &x : direction)
      x = uniformOf(generator);
  } while (direction.norm() > 1 || direction.norm() < 0.1);
  return direction.normalized();
}

// D of contacts of two balls, mass and radius 1, with walls along the axes and, the last one, with each other.
Eigen::MatrixXd delassusOfTwoBalls(std::mt19937 &generator, int walls) {
  const int contacts = walls + 1;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * contacts, 12);
  for (int i = 0; i < contacts; ++i) {
    const auto ball = static_cast<Eigen::Index>(generator() % 2);
    const auto wall = static_cast<Eigen::Index>(generator() % 5);
    const double sign = wall % 2 == 0 ? 1 : -1;
    const Eigen::Vector3d normal = i < walls ? sign * Eigen::Vector3d::Unit(wall / 2) : directionOf(generator);
    const Eigen::Vector3d along = Eigen::AngleAxisd(3 * uniformOf(generator), normal) * normal.unitOrthogonal();
    const std::array<Eigen::Vector3d, 3> directions = {normal, along, normal.cross(along)};
    for (int k = 0; k < 3; ++k) {
      const int row = k == 0 ? i : contacts + 2 * i + k - 1;
      const Eigen::Vector3d turn = directions[k].cross(normal);
      rows.block<1, 3>(row, 6 * ball) = directions[k].transpose();
      rows.block<1, 3>(row, 6 * ball + 3) = turn.transpose();
      if (i < walls)
        continue;
      rows.block<1, 3>(row, 6 * (1 - ball)) = -directions[k].transpose();
      rows.block<1, 3>(row, 6 * (1 - ball) + 3) = turn.transpose();
    }
  }
  Eigen::VectorXd mobility = Eigen::VectorXd::Ones(12);
  mobility.segment<3>(3).setConstant(2.5);
  mobility.tail<3>().setConstant(2.5);
  return rows * mobility.asDiagonal() * rows.transpose();
}

// Bounded forces have a solution, and it is found where the residual has minima that are none. Without free accelerations: what contacts
// at rest answer to those that push.
TEST(ConeFriction, WhatAnswersABoundedPushIsAlwaysFound) {
  constexpr int walls = 4, contacts = walls + 1;
  constexpr double friction = 0.4, tolerance = 1e-9;
  std::vector<unsigned> runs(500);
  std::iota(runs.begin(), runs.end(), 1U);
  runs.push_back(129593);  // from all starts but the scattered ones Newton's method ends in such a minimum
  ConeFrictionSolver solver;
  for (const unsigned run : runs) {
    std::mt19937 generator(run);
    ConeFrictionProblem &problem = solver.problem();
    problem.resize(contacts, 2 * contacts);
    problem.delassus.map() = delassusOfTwoBalls(generator, walls);
    for (int i = 0; i < contacts; ++i) {
      problem.normalKind[i] = i == 0 || uniformOf(generator) < -0.8 ? NormalKind::Prescribed : NormalKind::Unilateral;
      problem.upper[i] = 1;
      const bool slips = uniformOf(generator) < -0.4;
      for (const int j : {2 * i, 2 * i + 1}) {
        problem.owner[j] = i;
        problem.friction[j] = friction;
        problem.partner[j] = slips ? -1 : j ^ 1;
        problem.tangentKind[j] = !slips ? TangentKind::TwoSided : j == 2 * i ? TangentKind::Slip : TangentKind::None;
        problem.sign[j] = 1;
      }
    }
    const ConeFrictionSolution &solution = solver.solve(nullptr, tolerance);
    ASSERT_TRUE(solution.solved) << run << ": " << solution.violation;
    for (int i = 0; i < contacts; ++i) {
      const double force = solution.force[i], acceleration = solution.acceleration[i];
      const int row = contacts + 2 * i;
      EXPECT_GE(force, -1e-8);
      EXPECT_LE(force, 1 + 1e-8);
      EXPECT_LE(std::hypot(solution.force[row], solution.force[row + 1]), friction * force + 1e-8);
      if (problem.normalKind[i] == NormalKind::Prescribed)
        continue;
      EXPECT_TRUE(acceleration > -1e-7 || force > 1 - 1e-8) << run;
      EXPECT_TRUE(acceleration < 1e-7 || force < 1e-8) << run;
    }
  }
}

// Held forces may be rates: the friction of a slip follows those that fall, too.
TEST(ConeFriction, FrictionFollowsHeldForcesOfAnySign) {
  ConeFrictionSolver solver;
  ConeFrictionProblem &problem = solver.problem();
  problem.resize(1, 1);
  problem.delassus.map() << 2, 0.5, 0.5, 1;
  problem.bias = {3, 0};
  problem.normalKind[0] = NormalKind::Bilateral;
  problem.tangentKind[0] = TangentKind::Slip;
  problem.owner[0] = 0;
  problem.friction[0] = 0.5;
  problem.sign[0] = 1;
  const ConeFrictionSolution &solution = solver.solve(nullptr, 1e-12);
  ASSERT_TRUE(solution.solved);
  EXPECT_NEAR(solution.force[0], -3 / 1.75, 1e-12);
  EXPECT_NEAR(solution.force[1], 1.5 / 1.75, 1e-12);
}

test::SpatialBody fourFeet() {
  return test::spatialBody(2, 0.4 * Eigen::Matrix3d::Identity(), {{0.5, 0.4, 0}, {-0.5, 0.4, 0}, {-0.5, -0.4, 0}, {0.5, -0.4, 0}});
}

// Four feet in the plane of the centre, weight 20, μ = 0.5, pushed horizontally: forces within the cones until the push is 10.
TEST(ConeFriction, FourFeetStickUntilNoForceIsAdmissible) {
  ContactMode mode;
  mode.resize(4, 8);
  std::fill(mode.closed.begin(), mode.closed.end(), std::uint8_t{1});
  Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(6);
  // A torque about y loads two feet more.
  acceleration << 2, 0, -10, 0, 5, 0;
  ModeForces forces;
  ContactProblem problem = problemOf(fourFeet(), 0.5, acceleration);
  ASSERT_TRUE(forces.start(problem, mode));
  EXPECT_TRUE(forces.redundant());
  double normal = 0;
  for (int i = 0; i < 4; ++i) {
    normal += forces.forces()[i];
    EXPECT_LE(std::hypot(forces.forces()[4 + 2 * i], forces.forces()[5 + 2 * i]), 0.5 * forces.forces()[i]);
  }
  EXPECT_NEAR(normal, 20, 1e-10);
  // The least-norm shares of the push leave the cones of the lighter feet; the heavier ones take over up to 10 altogether.
  acceleration[0] = 4.9;
  problem = problemOf(fourFeet(), 0.5, acceleration);
  ASSERT_TRUE(forces.start(problem, mode));
  ASSERT_EQ(forces.margins().size(), 1U);
  // All feet can have the slack (10 − 9.8)/4 at once.
  EXPECT_NEAR(forces.marginValues()[0], 0.05, 1e-9);
  for (int i = 0; i < 4; ++i)
    EXPECT_LE(std::hypot(forces.forces()[4 + 2 * i], forces.forces()[5 + 2 * i]), 0.5 * forces.forces()[i] + 1e-9);
  acceleration[0] = 5.1;
  problem = problemOf(fourFeet(), 0.5, acceleration);
  EXPECT_FALSE(forces.start(problem, mode));
}

// At the border the next derivative decides: a growing push starts the slip of all feet along itself, a shrinking one does not.
TEST(ConeFriction, FeetAtTheBorderFollowTheNextDerivative) {
  Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(6);
  acceleration << 3, 4, -10, 0, 0, 0;
  const ContactProblem problem = problemOf(fourFeet(), 0.5, acceleration);
  ContactSolver solver;
  for (const double growth : {1.0, -1.0}) {
    const ContactSolution solution = solver.solve(problem);
    ASSERT_EQ(solution.degenerate.size(), 4U);
    ContactRates rates;
    rates.resize(4, 8);
    for (int i = 0; i < 4; ++i) {
      rates.accelerationRate[4 + 2 * i] = 0.6 * growth;
      rates.accelerationRate[5 + 2 * i] = 0.8 * growth;
    }
    const ContactSolution &resolved = solver.resolve(problem, solution, rates);
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(resolved.mode.slip[2 * i], growth > 0 ? 1 : 0);
      if (growth > 0) {
        EXPECT_NEAR(resolved.mode.direction[2 * i], 0.6, 1e-9);
        EXPECT_NEAR(resolved.mode.direction[2 * i + 1], 0.8, 1e-9);
      }
    }
  }
}

// The corners of a box's edge press with given forces, and their slips are zero or nearly: friction along the edge is shared in many ways,
// so that the equations are singular; the motion is one all the same.
TEST(ConeFriction, FrictionSharedAlongAnEdge) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  ConeFrictionSolver solver;
  for (int run = 0; run < 300; ++run) {
    const double a = 0.25 + 0.15 * uniform(generator), b = 0.25 + 0.15 * uniform(generator), c = 0.25 + 0.15 * uniform(generator);
    const Eigen::Vector3d inertia((b * b + c * c) / 3, (a * a + c * c) / 3, (a * a + b * b) / 3);
    const test::SpatialBody body = test::spatialBody(1, inertia.asDiagonal(), {{a, b, -c}, {a, -b, -c}});
    ConeFrictionProblem &problem = solver.problem();
    problem.resize(2, 4);
    problem.delassus.map() = body.rows * body.mass.inverse() * body.rows.transpose();
    Eigen::VectorXd motion(6);
    for (double &v : motion)
      v = (run % 2) * uniform(generator);
    Eigen::Map<Eigen::VectorXd>(problem.bias.data(), 6) = body.rows * motion;
    for (int i = 0; i < 2; ++i) {
      problem.normalKind[i] = NormalKind::Prescribed;
      problem.upper[i] = 1 + 0.5 * uniform(generator);
    }
    for (int j = 0; j < 4; ++j) {
      problem.owner[j] = j / 2;
      problem.partner[j] = j ^ 1;
      problem.tangentKind[j] = TangentKind::TwoSided;
      problem.friction[j] = 1 + uniform(generator) * (j % 2 == 0 ? 1 : 0);
    }
    problem.friction[1] = problem.friction[0];
    problem.friction[3] = problem.friction[2];
    const ConeFrictionSolution &solution = solver.solve(nullptr, 1e-9);
    EXPECT_TRUE(solution.solved) << run << ": " << solution.violation;
  }
}

}  // namespace
}  // namespace tf::runtime
