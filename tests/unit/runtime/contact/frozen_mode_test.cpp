#include "runtime/contact/frozen_mode.h"

#include "tests/unit/runtime/contact/spatial_bodies.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace tf::runtime::test {
namespace {

constexpr double rest = 1e-10;

// A body with random contacts, each of them with a slip of two components; `velocity` (n + m) at random.
struct Impact {
  FrozenProblem problem;
  std::vector<double> velocity;
  std::mt19937 generator;

  Impact(unsigned seed, int contacts) : generator(seed) {
    const SpatialBody body = spatialBody(generator, contacts);
    problem.resize(contacts, 2 * contacts);
    problem.delassus.map() = body.rows * body.mass.inverse() * body.rows.transpose();
    for (int i = 0; i < contacts; ++i) {
      problem.rate[i] = uniform(0.5, 2);
      for (const int j : {2 * i, 2 * i + 1}) {
        problem.owner[j] = i;
        problem.partner[j] = j == 2 * i ? j + 1 : j - 1;
      }
      problem.friction[2 * i] = problem.friction[2 * i + 1] = uniform(0, 0.6);
    }
    for (int r = 0; r < problem.count(); ++r)
      velocity.push_back(uniform(-1, 1));
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator); }

  // Contacts are held or push; the first one slips, the others as it comes.
  FrozenMode mode(bool holdsFirst) {
    FrozenMode mode;
    mode.resize(problem);
    for (int i = 0; i < problem.normalCount; ++i) {
      const bool held = i == 0 ? holdsFirst : uniform(0, 1) < 0.7;
      const bool slips = i == 0 || uniform(0, 1) < 0.5;
      mode.normal[i] = held ? FrozenMode::Normal::Held : FrozenMode::Normal::Push;
      mode.setTangent(problem, 2 * i, slips ? FrozenMode::Tangent::Slip : FrozenMode::Tangent::Stick, slips ? 1 : 0);
    }
    setDirections(mode);
    return mode;
  }

  // The same one, that knows no forces.
  [[nodiscard]] FrozenMode again(const FrozenMode &mode) const {
    FrozenMode same;
    same.resize(problem);
    same.normal = mode.normal;
    for (int j = 0; j < problem.tangentCount; j += 2)
      same.setTangent(problem, j, mode.tangent[j], mode.tangent[j] == FrozenMode::Tangent::Slip ? 1 : 0);
    setDirections(same);
    return same;
  }

  void setDirections(FrozenMode &mode) const {
    for (int i = 0; i < problem.normalCount; ++i)
      mode.setDirection(2 * i, velocity[slip(i)], velocity[slip(i) + 1]);
  }

  void turn(int contact, double angle) {
    double &x = velocity[slip(contact)], &y = velocity[slip(contact) + 1];
    const double turned = std::cos(angle) * x - std::sin(angle) * y;
    y = std::sin(angle) * x + std::cos(angle) * y;
    x = turned;
  }

  [[nodiscard]] int slip(int contact) const { return problem.normalCount + 2 * contact; }
  [[nodiscard]] Eigen::VectorXd accelerations(const std::vector<double> &force) const {
    return problem.delassus.map() * Eigen::Map<const Eigen::VectorXd>(force.data(), problem.count());
  }

  // Largest violation of the mode's conditions, relative to the forces.
  [[nodiscard]] double violation(const FrozenMode &mode, const std::vector<double> &force) const {
    const Eigen::VectorXd w = accelerations(force);
    double worst = 0, largest = 1;
    for (const double f : force)
      largest = std::max(largest, std::abs(f));
    for (int i = 0; i < problem.normalCount; ++i) {
      const int row = slip(i);
      worst = std::max(worst, std::abs(mode.normal[i] == FrozenMode::Normal::Held ? w[i] : force[i] - problem.rate[i]));
      const double speed = std::hypot(velocity[row], velocity[row + 1]), friction = problem.friction[2 * i] * force[i];
      for (const int r : {row, row + 1})
        worst =
            std::max(worst, std::abs(mode.tangent[2 * i] == FrozenMode::Tangent::Stick ? w[r] : force[r] + friction * velocity[r] / speed));
    }
    return worst / largest;
  }
};

class FrozenModeOf : public testing::TestWithParam<int> {};

TEST_P(FrozenModeOf, ForcesHoldWhatIsHeldAndOpposeSlips) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    Impact impact(seed, GetParam());
    FrozenMode mode = impact.mode(seed % 2 == 0);
    std::vector<double> force;
    ASSERT_TRUE(mode.forces(impact.problem, impact.velocity, rest, force)) << seed;
    EXPECT_LT(impact.violation(mode, force), 1e-8) << seed;
  }
}

// The forces of one piece with slips that turn are those of modes that begin there.
TEST_P(FrozenModeOf, ForcesTurnWithTheSlips) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    Impact impact(seed, GetParam());
    FrozenMode mode = impact.mode(seed % 2 == 0);
    std::vector<double> force, expected;
    for (int k = 0; k < 10; ++k) {
      for (int i = 0; i < impact.problem.normalCount; ++i)
        impact.turn(i, std::numbers::pi * impact.uniform(-0.1, 0.1));
      impact.setDirections(mode);
      ASSERT_TRUE(mode.forces(impact.problem, impact.velocity, rest, force));
      FrozenMode fresh = impact.again(mode);
      fresh.refer(std::vector<double>(force.size(), 0.0));
      ASSERT_TRUE(fresh.forces(impact.problem, impact.velocity, rest, expected));
      EXPECT_LT(impact.violation(mode, force), 1e-8) << seed;
      for (std::size_t r = 0; r < force.size(); ++r)
        EXPECT_NEAR(force[r], expected[r], 1e-8 * (1 + std::abs(expected[r]))) << seed;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Contacts, FrozenModeOf, testing::Values(1, 2, 3, 5),
                         [](const auto &parameter) { return std::to_string(parameter.param); });

// Five contacts of one body are redundant: of all forces that solve the equations, those nearest to the ones that are referred to. The
// motion is the same with all of them unless friction acts on a held contact that slips, whose share of the load is not determined.
TEST(FrozenMode, RedundantForcesStayNearTheirReference) {
  int redundant = 0, determined = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    Impact impact(seed, 5);
    FrozenMode mode = impact.mode(false);
    std::vector<double> first, other, reference(static_cast<std::size_t>(impact.problem.count()));
    ASSERT_TRUE(mode.forces(impact.problem, impact.velocity, rest, first));
    if (!mode.isRedundant())
      continue;
    ++redundant;
    for (double &entry : reference)
      entry = impact.uniform(0, 1);
    mode.refer(reference);
    ASSERT_TRUE(mode.forces(impact.problem, impact.velocity, rest, other));
    EXPECT_LT(impact.violation(mode, other), 1e-8) << seed;
    bool isDetermined = true;
    for (int i = 0; i < impact.problem.normalCount; ++i)
      isDetermined = isDetermined && (mode.normal[i] != FrozenMode::Normal::Held || mode.tangent[2 * i] != FrozenMode::Tangent::Slip);
    const Eigen::VectorXd moved = impact.accelerations(first), same = impact.accelerations(other);
    determined += isDetermined ? 1 : 0;
    if (isDetermined) {
      EXPECT_LT((moved - same).lpNorm<Eigen::Infinity>(), 1e-8 * (1 + moved.lpNorm<Eigen::Infinity>())) << seed;
    }
    mode.refer(other);
    std::vector<double> again;
    ASSERT_TRUE(mode.forces(impact.problem, impact.velocity, rest, again));
    for (std::size_t r = 0; r < again.size(); ++r)
      EXPECT_NEAR(again[r], other[r], 1e-8 * (1 + std::abs(other[r]))) << seed;
  }
  EXPECT_GT(redundant, 20);
  EXPECT_GT(determined, 10);
}

}  // namespace
}  // namespace tf::runtime::test
