#include "runtime/contact/force_set.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <vector>

namespace tf::runtime {
namespace {

// A beam of mass 1 and moment of inertia 1/3 on three supports at x = −1, 0, 1, with a load of 1 at x = `place`.
ContactProblem beam(double place) {
  ContactProblem problem;
  problem.resize(3, 0);
  Eigen::MatrixXd J(3, 2);
  J << 1, -1, 1, 0, 1, 1;
  const Eigen::Vector2d free(-1, -3 * place);
  problem.delassus.map() = J * Eigen::Vector2d(1, 3).asDiagonal() * J.transpose();
  Eigen::Map<Eigen::VectorXd>(problem.bias.data(), 3) = J * free;
  return problem;
}

std::vector<int> fixedOf(const ContactProblem &problem, ForceSet &set) {
  ContactMode mode;
  mode.resize(3, 0);
  mode.closed.assign(3, 1);
  set.setMode(problem, mode);
  EXPECT_TRUE(set.singular(problem));
  EXPECT_EQ(set.solveLeastNorm(problem, 1e-9), LeastNorm::Status::Solved);
  std::vector<int> fixed = {0, 1, 2};
  set.keepFixed(problem, fixed, 1e-7);
  return fixed;
}

// N₁ + N₂ + N₃ = 1, N₃ − N₁ = place: N₁ = t, N₂ = 1 − place − 2 t. Of a load beyond 2/3 the least norm leaves N₁ = 0, which may grow all
// the same; at the end the third support bears all.
TEST(ForceSet, KeepsLimitsThatNoForcesLeave) {
  ForceSet set;
  EXPECT_EQ(fixedOf(beam(0), set), std::vector<int>());
  EXPECT_EQ(fixedOf(beam(0.5), set), std::vector<int>());
  EXPECT_EQ(fixedOf(beam(0.8), set), std::vector<int>());
  EXPECT_NEAR(set.forces()[0], 0, 1e-9);
  EXPECT_EQ(fixedOf(beam(1), set), std::vector<int>({0, 1}));
  EXPECT_NEAR(set.forces()[2], 1, 1e-9);
  EXPECT_EQ(fixedOf(beam(-1), set), std::vector<int>({1, 2}));
}

// In free fall nothing presses the beam on its supports, and what rounding leaves of its weight may pull it up: that is no load without
// admissible forces. As a load of its own size it is one.
TEST(ForceSet, WhatRoundingLeavesOfALoadIsNone) {
  ContactProblem problem = beam(0);
  problem.bias = {2e-16, 1e-16, -1e-16};
  ContactMode mode;
  mode.resize(3, 0);
  mode.closed.assign(3, 1);
  ForceSet set;
  set.setMode(problem, mode);
  ASSERT_TRUE(set.singular(problem));
  EXPECT_NE(set.solveLeastNorm(problem, 1e-9), LeastNorm::Status::Solved);
  problem.load = 1;
  EXPECT_EQ(set.solveLeastNorm(problem, 1e-9), LeastNorm::Status::Solved);
  for (const double force : set.forces())
    EXPECT_NEAR(force, 0, 1e-15);
}

}  // namespace
}  // namespace tf::runtime
