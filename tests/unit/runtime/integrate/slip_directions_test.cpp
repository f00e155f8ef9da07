// Slips of two components that begin: the direction is the mode's, whatever rounding has left of the slip.
#include "runtime/integrate/mode_dynamics.h"
#include "runtime/model/input_signals.h"
#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace tf::runtime {
namespace {

// A particle of mass 1 on a floor with μ = 0.5 slips with (3e-11, −4e-11) m/s.
struct SlowParticle {
  SlowParticle() : inputs(test::particle3dModel().nu), at(test::particle3dModel(), inputs), dynamics(at) {
    EXPECT_TRUE(at.setParameters(instance.parameters().data()));
    at.setSegment(0.5);
    dynamics.setSlipAccuracy(1e-7);
    mode.closed = {1};
    mode.tangent = {Tangent::SlipPositive, Tangent::SlipPositive};
  }
  void start() { ASSERT_TRUE(dynamics.start(mode, 0, state.data(), rate.data())); }

  ModelInstance instance{test::particle3dModel()};
  InputSignals inputs;
  ModelEvaluation at;
  ModeDynamics dynamics;
  Mode mode;
  std::vector<double> state = {0, 0, 0, 3e-11, -4e-11, 0, 0}, rate = std::vector<double>(state.size());
  static constexpr double friction = 0.5 * 9.81;
};

TEST(SlipDirections, OfASlowSlipIsItsOwn) {
  SlowParticle particle;
  particle.start();
  EXPECT_NEAR(particle.rate[3], -0.6 * SlowParticle::friction, 1e-9);
  EXPECT_NEAR(particle.rate[4], 0.8 * SlowParticle::friction, 1e-9);
}

// But for a part of the order of the slip over its accuracy.
TEST(SlipDirections, OfOneThatTheModeStartsIsThatOfTheMode) {
  SlowParticle particle;
  particle.mode.direction = {-0.8, 0.6};
  particle.start();
  EXPECT_NEAR(particle.rate[3], 0.8 * SlowParticle::friction, 1e-6);
  EXPECT_NEAR(particle.rate[4], -0.6 * SlowParticle::friction, 1e-6);
  const std::vector<double> scale(particle.state.size(), 1.0);
  particle.dynamics.projectStart(0, particle.state.data(), scale.data());
  EXPECT_NEAR(particle.state[3], 0, 1e-20);
  EXPECT_NEAR(particle.state[4], 0, 1e-20);
}

// Where the next step begins the slip is there, and friction jumps to it.
TEST(SlipDirections, AreThoseOfTheSlipsFromTheNextStepOn) {
  SlowParticle particle;
  particle.mode.direction = {-0.8, 0.6};
  particle.start();
  EXPECT_TRUE(particle.dynamics.renewDirections(0, particle.state.data()));
  ASSERT_TRUE(particle.dynamics.evaluate(0, particle.state.data(), particle.rate.data()));
  EXPECT_NEAR(particle.rate[3], -0.6 * SlowParticle::friction, 1e-9);
  EXPECT_NEAR(particle.rate[4], 0.8 * SlowParticle::friction, 1e-9);
  EXPECT_FALSE(particle.dynamics.renewDirections(0, particle.state.data()));
}

}  // namespace
}  // namespace tf::runtime
