// Gaps that just reach zero inside a long step, or just do not: neither is missed or invented.
#include "tests/accuracy/compiled_model.h"

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
      for (const double depth : {1e-1, 1e-2, 1e-3, 2e-4}) {
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

}  // namespace
}  // namespace tf::test
