// Gaps, slips, conditions and forces that just reach zero inside a long step, or just do not: neither is missed or invented.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/support/compiled_model.h"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace tf::test {
namespace {

// x = cos t, above a floor at −1 + depth.
std::string oscillator(double depth) {
  return sourceFile(fmt::format("oscillator_{}.tf", depth), fmt::format(R"(
model Oscillator
  coordinate Real x(start = 1);
  body b(mass = 1, position = x);
  force spring(value = -x, at = x);
  contact floor(gap = x + 1 - ({:.17g}));
  contact ceiling(gap = 1.5 - x);
end Oscillator;
)",
                                                                        depth));
}

TEST(Grazing, GapsThatReachZeroInsideALongStep) {
  for (const auto integrator : {TF_AUTO, TF_EXPLICIT, TF_STEP})
    for (const double tolerance : {1e-6, 1e-7, 1e-9}) {
      for (const double depth : {1e-1, 1e-2, 1e-3, 2e-4, 100 * tolerance, 20 * tolerance}) {
        CompiledModel model(oscillator(depth));
        model.tolerance(tolerance).integrator(integrator).run(4);
        ASSERT_FALSE(model.events().empty()) << depth << ' ' << tolerance;
        const double expected = std::acos(depth - 1), speed = std::sin(expected);
        EXPECT_NEAR(model.events().front().time, expected, 10 * tolerance / speed) << depth << ' ' << tolerance;
        EXPECT_GE(model["floor.gap"], -1e-9);
      }
      CompiledModel above(oscillator(-2e-4));
      above.tolerance(tolerance).integrator(integrator).run(4);
      EXPECT_TRUE(above.events().empty()) << tolerance;
      EXPECT_NEAR(above["x"], std::cos(4.0), 10 * tolerance);
    }
}

// x = c sin t before a wall at 1, of which the step's ends alone say less than the step knows.
TEST(Grazing, GapsThatDipByALittleMoreThanTheTolerance) {
  const std::string file = sourceFile("dip.tf", R"(
model Dip
  parameter Real c = 1;
  coordinate Real x(der(start = c));
  body b(mass = 1, position = x);
  force drive(value = -c*sin(time), at = x);
  contact wall(gap = 1 - x, restitution = 0.5);
end Dip;
)");
  for (const auto integrator : {TF_AUTO, TF_EXPLICIT, TF_STEP})
    for (const double tolerance : {1e-6, 1e-8, 1e-9})
      for (const double depth : {100 * tolerance, 30 * tolerance}) {
        SCOPED_TRACE(fmt::format("integrator {}, {}, {}", static_cast<int>(integrator), tolerance, depth));
        const double c = 1 + depth, time = std::asin(1 / c), speed = std::sqrt(c * c - 1);
        CompiledModel model(file, {{"c", c}});
        model.tolerance(tolerance).integrator(integrator).run(3);
        ASSERT_EQ(model.count(TF_EVENT_IMPACT), 1);
        EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), time, 10 * tolerance / speed);
        EXPECT_NEAR(model["x"], c * std::sin(3.0) - 1.5 * speed * (3 - time), 10 * tolerance / speed);
      }
}

// x = f − cos t on a belt of speed 1 − excess: friction f pushes until the block sticks, and again once the spring pulls as much.
std::string block(double excess) {
  return sourceFile(fmt::format("block_on_belt_{}.tf", excess), fmt::format(R"(
model Block
  coordinate Real x(start = 0.5 - 1);
  coordinate Real y;
  body b(mass = 1, position = {{x, y}});
  gravity weight(acceleration = {{0, -10}});
  force spring(value = -x, at = x);
  contact belt(gap = y, slip = der(x) - (1 - ({:.17g})), friction = 0.05);
end Block;
)",
                                                                            excess));
}

TEST(Grazing, SlipsThatReachZeroInsideALongStep) {
  for (const auto integrator : {TF_AUTO, TF_EXPLICIT, TF_STEP})
    for (const double tolerance : {1e-6, 1e-7, 1e-9}) {
      for (const double excess : {1e-1, 1e-2, 1e-3, 2e-4}) {
        CompiledModel model(block(excess));
        model.tolerance(tolerance).integrator(integrator).run(4);
        const double speed = 1 - excess, stick = std::asin(speed), slip = stick + std::cos(stick) / speed;
        ASSERT_EQ(model.events().size(), 2) << excess << ' ' << tolerance;
        EXPECT_NEAR(model.events()[0].time, stick, 10 * tolerance / std::cos(stick)) << excess << ' ' << tolerance;
        EXPECT_NEAR(model.events()[1].time, slip, 20 * tolerance / std::cos(stick)) << excess << ' ' << tolerance;
        EXPECT_NEAR(model["x"], 0.5 + speed * std::sin(4 - slip), 20 * tolerance / std::cos(stick));
      }
      CompiledModel slower(block(-2e-4));
      slower.tolerance(tolerance).integrator(integrator).run(4);
      EXPECT_TRUE(slower.events().empty()) << tolerance;
      EXPECT_NEAR(slower["x"], 0.5 - std::cos(4.0), 10 * tolerance);
    }
}

// The same in space, where the slip has two components.
std::string blockInSpace(double excess) {
  return sourceFile(fmt::format("block_on_belt_in_space_{}.tf", excess), fmt::format(R"(
model Block
  coordinate Real r[3](start = {{0.5 - 1, 0, 0}});
  body b(mass = 1, position = r);
  gravity weight(acceleration = {{0, 0, -10}});
  force spring(value = {{-r[1], -r[2]}}, at = {{r[1], r[2]}});
  contact belt(gap = r[3], slip = {{der(r[1]) - (1 - ({:.17g})), der(r[2])}}, friction = 0.05);
end Block;
)",
                                                                                     excess));
}

TEST(Grazing, SlipsOfTwoComponentsThatReachZeroInsideALongStep) {
  for (const double tolerance : {1e-6, 1e-7, 1e-9})
    for (const double excess : {1e-1, 1e-2, 1e-3}) {
      CompiledModel model(blockInSpace(excess));
      model.tolerance(tolerance).run(4);
      const double speed = 1 - excess, stick = std::asin(speed), slip = stick + std::cos(stick) / speed;
      ASSERT_EQ(model.count(TF_EVENT_STICK), 1) << excess << ' ' << tolerance;
      EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), stick, 10 * tolerance / std::cos(stick)) << excess << ' ' << tolerance;
      EXPECT_NEAR(model["r[1]"], 0.5 + speed * std::sin(4 - slip), 20 * tolerance / std::cos(stick)) << excess << ' ' << tolerance;
    }
}

// x' = sin t is above 1 − excess for a while.
TEST(Grazing, ConditionsThatHoldForAWhileInsideALongStep) {
  const std::string text = R"(
model Counter
  coordinate Real x(start = -1);
  body b(mass = 1, position = x);
  force spring(value = -x, at = x);
  parameter Real excess = 0.1;
  Real z(start = 0);
equation
  der(z) = if der(x) > 1 - excess then 1 else 0;
end Counter;
)";
  const std::string file = sourceFile("counter.tf", text);
  for (const auto integrator : integrators)
    for (const double tolerance : {1e-6, 1e-7, 1e-9})
      for (const double excess : {1e-1, 1e-2, 1e-3, 2e-4}) {
        CompiledModel model(file, {{"excess", excess}});
        model.tolerance(tolerance).integrator(integrator).run(4);
        const double half = std::acos(1 - excess);
        EXPECT_NEAR(model["z"], 2 * half, 20 * tolerance / half) << integrator << ' ' << excess << ' ' << tolerance;
      }
}

// A body rides over a crest, which turns below it at a constant speed (but for a part of 1e-12): it leaves the ground where its normal
// force 10 − a cos θ, a = 10 (1 + excess), vanishes, and comes back after a hop of s t³/6 − c t⁴/24 and so on with sine and cosine at its
// begin.
TEST(Grazing, ForcesThatVanishForAWhileInsideALongStep) {
  const std::string file = sourceFile("crest.tf", R"(
model Crest
  parameter Real excess = 0.01;
  parameter Real a = 10*(1 + excess);
  coordinate Real theta(start = -2, der(start = 1));
  coordinate Real y(start = a*cos(2), der(start = a*sin(2)));
  body wheel(angle = theta, inertia = 1e14);
  body rider(mass = 1, position = {0, y});
  gravity weight(acceleration = {0, -10});
  contact ground(gap = y - a*cos(theta));
end Crest;
)");
  for (const auto integrator : {TF_AUTO, TF_EXPLICIT, TF_STEP})
    for (const double tolerance : {1e-4, 1e-6, 1e-7, 1e-9})
      for (const double excess : {1e-2, 1e-3, 1e-4, 1e-5}) {
        CompiledModel model(file, {{"excess", excess}});
        model.tolerance(tolerance).integrator(integrator).run(3);
        const double angle = std::acos(1 / (1 + excess)), opening = 2 - angle;
        ASSERT_EQ(model.count(TF_EVENT_OPENING), 1) << integrator << ' ' << excess << ' ' << tolerance;
        EXPECT_NEAR(model.eventTime(TF_EVENT_OPENING), opening, 10 * tolerance * (1 + 1e-3 / angle)) << excess << ' ' << tolerance;
        // The hop ends where c (1 − t²/2 − cos t) + s (t − sin t) is zero again.
        double hop = 4 * std::tan(angle);
        for (int k = 0; k < 20; ++k) {
          const double value = std::cos(angle) * (1 - hop * hop / 2 - std::cos(hop)) + std::sin(angle) * (hop - std::sin(hop));
          hop -= value / (std::cos(angle) * (std::sin(hop) - hop) + std::sin(angle) * (1 - std::cos(hop)));
        }
        if (hop > 100 * std::sqrt(tolerance)) {
          EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT) - opening, hop, 0.01 * hop) << excess << ' ' << tolerance;
        }
      }
}

// Where rates and the ends of steps show that nothing happens inside them, no more is evaluated than the stages.
TEST(Grazing, FarGapsAndFastSlipsTakeNoEvaluations) {
  CompiledModel model(block(-1));
  model.tolerance(1e-7).integrator(TF_EXPLICIT).initialise();
  const long long before = tf_get_statistics(model.simulation())->evaluations;
  model.advance(6);
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_LE(statistics.evaluations - before, 12 * (statistics.steps + statistics.rejected_steps) + 4);
  EXPECT_NEAR(model["x"], 0.5 - std::cos(6.0), 1e-6);
}

// A follower leaves a cam at no speed and no acceleration: the errors of steps do not close the gap again.
TEST(Grazing, GapsThatOpenSlowly) {
  const double lift = 0.2, speed = 10;
  const double start = -std::acos(0.0), leaves = (std::acos(0.0) - std::acos(g / (lift * speed * speed))) / speed;
  for (const auto integrator : {TF_AUTO, TF_EXPLICIT, TF_STEP, TF_CVODE})
    for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
      CompiledModel model(sourceFile("follower.tf", fmt::format(R"(
model Follower
  coordinate Real phi(start = {:.17g}, der(start = {}));
  coordinate Real y(start = 0, der(start = {}));
  body cam(mass = 1, position = {{0, 0}}, angle = phi, inertia = 1);
  body follower(mass = 1e-6, position = {{0, y}});
  gravity weight(acceleration = {{0, -{}}});
  contact tip(gap = y - {}*cos(phi));
end Follower;
)",
                                                                start, speed, lift * speed, g, lift)));
      model.tolerance(tolerance).integrator(integrator).initialise();
      for (int k = 0; k <= 400; ++k) {
        model.advance(0.9 * leaves + k * 1e-4);
        EXPECT_GE(model["tip.gap"], -1e-9) << tolerance << ' ' << integrator << ' ' << model.time();
      }
      ASSERT_EQ(model.events().size(), 1) << tolerance << ' ' << integrator;
      EXPECT_NEAR(model.events()[0].time, leaves, 10 * tolerance);
    }
}

}  // namespace
}  // namespace tf::test
