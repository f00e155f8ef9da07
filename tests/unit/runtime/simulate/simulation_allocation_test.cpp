// A run allocates nothing when it is repeated: integrators, events, impacts and rest included.
#include "runtime/simulate/simulation.h"

#include "tests/unit/runtime/allocation_counter.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace tf::runtime {
namespace {

long allocationsOfSecondRun(const tf_model &model, const std::vector<std::pair<std::string, double>> &settings, double end) {
  ModelInstance instance(model);
  InputSignals inputs(model.nu);
  Simulation simulation(instance, inputs);
  for (const auto &[name, value] : settings)
    EXPECT_TRUE(instance.set(name, value).ok()) << name;
  simulation.options.tolerance = 1e-8;
  long count = 0;
  for (int run = 0; run < 2; ++run) {
    const long before = test::allocations;
    EXPECT_EQ(simulation.initialise(0), TF_OK) << simulation.errorText();
    EXPECT_EQ(simulation.advanceTo(end), TF_OK) << simulation.errorText();
    count = test::allocations - before;
  }
  return count;
}

TEST(SimulationAllocation, CountsThoseOfTheFirstRun) {
  const long before = test::allocations;
  EXPECT_EQ(allocationsOfSecondRun(test::particleModel(), {}, 0.1), 0);
  EXPECT_GT(test::allocations, before);
}

TEST(SimulationAllocation, NoneInBounces) { EXPECT_EQ(allocationsOfSecondRun(test::particleModel(), {{"e", 0.8}}, 2), 0); }

TEST(SimulationAllocation, NoneInSlipAndStick) {
  EXPECT_EQ(allocationsOfSecondRun(test::particleModel(), {{"mu", 0.3}, {"q[2]", 0}, {"der(q[1])", 1}}, 2), 0);
}

TEST(SimulationAllocation, NoneInFallsOfARod) { EXPECT_EQ(allocationsOfSecondRun(test::rodModel(), {}, 1.5), 0); }

TEST(SimulationAllocation, NoneInFallsOfABox) { EXPECT_EQ(allocationsOfSecondRun(test::boxModel(), {}, 2), 0); }

TEST(SimulationAllocation, NoneInSlidingOfASwitch) { EXPECT_EQ(allocationsOfSecondRun(test::relayModel(), {}, 2), 0); }

}  // namespace
}  // namespace tf::runtime
