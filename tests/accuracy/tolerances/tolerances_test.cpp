// Every example at every tolerance. With the environment variable TF_TOLERANCES=FILE the ratios of errors to bounds are appended to a file.
#include "tests/accuracy/tolerances/references.h"
#include "tests/accuracy/tolerances/sweep.h"

#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

constexpr const char *kIntegratorNames[] = {"auto", "step", "cvode", "explicit"};

std::vector<SweepCase> cases() {
  const auto lift = [](CompiledModel &model) {
    const double times[] = {0, 1, 3}, forces[] = {0, 0, 4 * 9.81};
    tf_set_input_table(model.simulation(), "u[2]", times, forces, 3, 1);
  };
  return {
      {"particle", "particle.tf", particleReference, {{"mu", 0.3}, {"g", 10}, {"u[1]", 2}, {"der(q[1])", 1}}},
      {"particle_lift_off", "particle.tf", liftedParticleReference, {{"mu", 0.6}, {"u[1]", 7}}, lift},
      {"incline", "incline.tf", inclineReference},
      {"incline_stays", "incline.tf", stayingInclineReference, {{"mu", 0.7}}},
      {"corner", "corner.tf", cornerReference},
      {"carts", "carts.tf", cartsReference},
      {"bouncing_ball", "bouncing_ball.tf", bouncingBallReference},
      {"two_walls", "two_walls.tf", twoWallsReference},
      {"superball", "superball.tf", superballReference},
      {"moving_ground", "moving_ground.tf", movingGroundReference},
      {"particle3d", "particle3d.tf", particle3dReference},
      {"column", "column.tf", columnReference},
      {"relay", "relay.tf", relayReference},
      {"thermostat", "thermostat.tf", thermostatReference},
      {"stickslip", "stickslip.tf", stickSlipReference, {{"x", -0.5}, {"der(x)", 0}}},
      {"pushed_block", "pushed_block.tf", pushedBlockReference},
      {"den_hartog", "den_hartog.tf", denHartogReference},
      {"duffing", "duffing.tf", duffingReference},
      {"dragged_table", "dragged_table.tf", draggedTableReference},
      {"falling_rod", "falling_rod.tf", fallingRodReference},
      {"falling_box", "falling_box.tf", fallingBoxReference},
      {"painleve_rod", "painleve_rod.tf", painleveRodReference, {{"der(r[1])", -10}, {"der(r[2])", 0}, {"der(phi)", 0}}},
      {"rocking_block", "rocking_block.tf", rockingBlockReference, {}, {}, {"tilt"}},
      {"rimless_wheel", "rimless_wheel.tf", rimlessWheelReference, {}, {}, {"w"}},
      {"pendulum_wall", "pendulum_wall.tf", pendulumWallReference},
      {"newtons_cradle", "newtons_cradle.tf", newtonsCradleReference},
      {"chain", "chain.tf", chainReference},
      {"slider_crank", "slider_crank.tf", sliderCrankReference},
      {"four_bar", "four_bar.tf", fourBarReference},
      {"spinning_top", "spinning_top.tf", spinningTopReference},
      {"three_carts", "three_carts.tf", threeCartsReference},
      {"double_pendulum", "double_pendulum.tf", doublePendulumReference},
      {"woodpecker", "woodpecker.tf", woodpeckerReference},
      {"backspin_ball", "backspin_ball.tf", backspinBallReference},
      {"tippe_top", "tippe_top.tf", tippeTopReference},
      {"tumbling_box", "tumbling_box.tf", tumblingBoxReference},
  };
}

class Tolerances : public testing::TestWithParam<SweepCase> {};

TEST_P(Tolerances, BoundTheErrors) {
  SweepCase sweepCase = GetParam();
  sweepCase.file = example(sweepCase.file);
  const Reference reference = sweepCase.reference();
  const Sensitivity sensitivity = sensitivityOf(sweepCase, reference);
  std::ofstream table;
  if (const char *file = std::getenv("TF_TOLERANCES"))
    table.open(file, std::ios::app);
  table << sweepCase.name << ": kappa " << sensitivity.states.back() << '\n';
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP, TF_EXPLICIT, TF_CVODE})
    for (int digits = 4; digits <= 10; ++digits) {
      const SweepResult result = compare(sweepCase, reference, sensitivity, std::pow(10.0, -digits), integrator);
      table << "  " << kIntegratorNames[integrator] << " 1e-" << digits << ": states " << result.stateRatio << " (" << result.state
            << "), events " << result.eventRatio << " (" << result.event << ") " << result.failure << '\n';
      SCOPED_TRACE(std::string(kIntegratorNames[integrator]) + ", tolerance 1e-" + std::to_string(digits));
      EXPECT_EQ(result.failure, "");
      EXPECT_LE(result.stateRatio, 1) << result.state;
      EXPECT_LE(result.eventRatio, 1) << result.event;
    }
}

TEST_P(Tolerances, SensitivitiesAreThoseOfDifferences) {
  SweepCase sweepCase = GetParam();
  sweepCase.file = example(sweepCase.file);
  EXPECT_EQ(sensitivityMismatch(sweepCase, sweepCase.reference()), "");
}

INSTANTIATE_TEST_SUITE_P(Examples, Tolerances, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<SweepCase> &testCase) { return testCase.param.name; });

}  // namespace
}  // namespace tf::test
