// Impacts of the reference trajectories (contract/reference): the states before them follow from free flight in closed form.
#include "runtime/contact/frozen_phase.h"

#include "tests/unit/runtime/contact/mechanisms.h"

#include <gtest/gtest.h>

#include <numbers>

namespace tf::runtime {
namespace {

using test::body;
using test::chain;
using test::frozen;
using test::velocityAfter;

constexpr double standardGravity = 9.81;

void expectVelocity(const Eigen::VectorXd &value, const Eigen::VectorXd &expected, double tolerance) {
  ASSERT_EQ(value.size(), expected.size());
  for (int k = 0; k < value.size(); ++k)
    EXPECT_NEAR(value(k), expected(k), tolerance) << "component " << k;
}

TEST(ReferenceImpacts, FallingRodFirstImpact) {
  const auto rod = body(1, 1.0 / 12, std::numbers::pi / 4, {{-0.5, 0}, {0.5, 0}}, 0.3);
  const Eigen::Vector3d before(2, -standardGravity * 0.31927542840705037, 0);
  FrozenPhase phase;
  const FrozenResult &result = phase.run(frozen(rod, before, {0}));
  expectVelocity(velocityAfter(rod, before, {0}, result.impulse),
                 Eigen::Vector3d(1.8079484158383492, -1.9944861221008892, -5.6412586476799955), 1e-11);
}

TEST(ReferenceImpacts, FallingRodSecondImpactAfterAFlight) {
  const double flight = 0.38223288812574296 - 0.31927542840705037;
  const auto rod = body(1, 1.0 / 12, 0.43023884932340861, {{-0.5, 0}, {0.5, 0}}, 0.3);
  const Eigen::Vector3d before(1.8079484158383492, -1.9944861221008892 - standardGravity * flight, -5.6412586476799955);
  FrozenPhase phase;
  const FrozenResult &result = phase.run(frozen(rod, before, {0}));
  expectVelocity(velocityAfter(rod, before, {0}, result.impulse),
                 Eigen::Vector3d(1.8041368928964361, -2.5993937254682198, -5.7200803721707603), 1e-11);
}

TEST(ReferenceImpacts, FallingBoxOnOneCorner) {
  const double t = 0.29174008758950942;
  const auto box = body(1, 1.36 / 12, 2.066960350358038, {{-0.5, 0.3}}, 0.2);
  const Eigen::Vector3d before(3, -standardGravity * t, 4);
  FrozenPhase phase;
  const FrozenResult &result = phase.run(frozen(box, before, {0}));
  expectVelocity(velocityAfter(box, before, {0}, result.impulse),
                 Eigen::Vector3d(2.4255744554851284, 0.010157463321270817, 0.39374998899715624), 1e-11);
}

TEST(ReferenceImpacts, ChainFirstNode) {
  const auto links = chain({0.9, 0.65, 0.4}, 1.0 / 3, 1.0 / 3, 0.5);
  Eigen::VectorXd before(5), after(5);
  before << 0.5, -standardGravity * 0.24730968341474902, 0, 0, 0;
  after << -0.78987871783712726, 0, -7.7303882917258626, 0.10775805775734876, -2.296562666759546;
  FrozenPhase phase;
  const FrozenResult &result = phase.run(frozen(links, before, {0}));
  expectVelocity(velocityAfter(links, before, {0}, result.impulse), after, 1e-11);
}

}  // namespace
}  // namespace tf::runtime
