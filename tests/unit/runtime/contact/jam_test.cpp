#include "runtime/contact/jam.h"

#include <gtest/gtest.h>

namespace {

using namespace tf::runtime;

// Contacts, each with one slip of direction 1, whose forces act on each other's normal accelerations by `coupling`, and by friction
// through D_nt = `tilt` of their own slip and `crossTilt` of the other's.
struct Pair {
  ContactProblem problem;
  ContactMode mode;

  Pair(double coupling, double tilt, double crossTilt, double friction) {
    problem.resize(2, 2);
    mode.resize(2, 2);
    for (int i = 0; i < 2; ++i) {
      const int other = 1 - i;
      problem.owner[i] = i;
      problem.friction[i] = friction;
      problem.slipSign[i] = 1;
      mode.closed[i] = 1;
      mode.slip[i] = 1;
      problem.delassus(i, i) = 2;
      problem.delassus(i, other) = coupling;
      problem.delassus(2 + i, 2 + i) = 3;
      problem.delassus(i, 2 + i) = problem.delassus(2 + i, i) = tilt;
      problem.delassus(i, 2 + other) = problem.delassus(2 + other, i) = crossTilt;
    }
  }
};

// Row −1: there is none.
Jam firstJam(const ContactProblem &problem, const ContactMode &mode) {
  const std::vector<Jam> jams = jammedNormals(problem, mode);
  return jams.empty() ? Jam{} : jams.front();
}

TEST(Jam, TheSlipOfOneContactPressesItIn) {
  // D_s = 2 − μ: zero at μ = 2.
  EXPECT_EQ(firstJam(Pair(0, 1, 0, 1.9).problem, Pair(0, 1, 0, 1.9).mode).row, -1);
  EXPECT_GE(firstJam(Pair(0, 1, 0, 1.9999).problem, Pair(0, 1, 0, 1.9999).mode).row, 0);
}

TEST(Jam, TheResponseTellsTheAccelerationWithoutTheForce) {
  const Jam jam = firstJam(Pair(0, 1, 0, 1.9999).problem, Pair(0, 1, 0, 1.9999).mode);
  EXPECT_NEAR(jam.response, 2 - 1.9999, 1e-14);
  EXPECT_EQ(jam.own, 2);
}

TEST(Jam, SlipsOfTwoContactsPressEachOtherIn) {
  // D_s = [2, −μ; −μ, 2]: no contact alone loses anything, both together everything at μ = 2.
  const Pair before(0, 0, 1, 1.9), at(0, 0, 1, 1.9999);
  EXPECT_EQ(firstJam(before.problem, before.mode).row, -1);
  EXPECT_GE(firstJam(at.problem, at.mode).row, 0);
}

TEST(Jam, AllThatAreJammedAreTold) {
  // Each contact by its own slip, D_s = 2 − μ.
  Pair pair(0, 1, 0, 1.9999);
  pair.problem.friction[1] = 2.1;
  std::vector<int> rows;
  for (const Jam &jam : jammedNormals(pair.problem, pair.mode))
    rows.push_back(jam.row);
  EXPECT_EQ(rows, (std::vector<int>{1, 0})) << "what has the least left comes first";
}

TEST(Jam, SticksTakePart) {
  // One contact that slips, μ = 1.9, and a friction element. Alone D_s = 2 − 1.9 = 0.1 of 2; while the element sticks, its force takes
  // 1 − 1.9·0.4737 = 0.09997 of it and leaves 3e-5 of 1.
  ContactProblem problem;
  ContactMode mode;
  problem.resize(1, 2);
  mode.resize(1, 2);
  problem.owner = {0, -1};
  problem.friction = {1.9, 0};
  problem.bound = {0, 1};
  const double delassus[3][3] = {{2, 1, 1}, {1, 3, 0.4737}, {1, 0.4737, 1}};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      problem.delassus(r, c) = delassus[r][c];
  mode.closed = {1};
  mode.slip = {1, 0};
  EXPECT_EQ(firstJam(problem, mode).row, 0);
  mode.slip = {1, 1};
  EXPECT_EQ(firstJam(problem, mode).row, -1);
}

TEST(Jam, RedundantRowsElsewhereDoNotMatter) {
  // Slips of two contacts that press each other in, and two friction elements on another body that stick as one.
  const auto withElements = [](const Pair &pair) {
    ContactProblem problem;
    ContactMode mode;
    problem.resize(2, 4);
    mode.resize(2, 4);
    for (int j = 0; j < 2; ++j) {
      problem.owner[j] = j;
      problem.friction[j] = pair.problem.friction[j];
      problem.slipSign[j] = mode.slip[j] = 1;
      mode.closed[j] = 1;
      problem.bound[2 + j] = 1;
    }
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c)
        problem.delassus(r, c) = pair.problem.delassus(r, c);
    for (int r = 4; r < 6; ++r)
      for (int c = 4; c < 6; ++c)
        problem.delassus(r, c) = 1;
    return firstJam(problem, mode).row;
  };
  EXPECT_EQ(withElements(Pair(0, 0, 1, 1.9)), -1);
  EXPECT_GE(withElements(Pair(0, 0, 1, 1.9999)), 0);
}

TEST(Jam, RedundantContactsAreLookedAtAlone) {
  // D = [2, 2; 2, 2] is singular without any friction.
  const Pair pair(2, 0.5, 0.5, 1);
  EXPECT_EQ(firstJam(pair.problem, pair.mode).row, -1);
  const Pair jam(2, 1, 1, 2);
  EXPECT_GE(firstJam(jam.problem, jam.mode).row, 0);
}

TEST(Jam, WithoutContactsThereIsNone) {
  ContactProblem problem;
  ContactMode mode;
  problem.resize(0, 0);
  mode.resize(0, 0);
  EXPECT_EQ(firstJam(problem, mode).row, -1);
}

}  // namespace
