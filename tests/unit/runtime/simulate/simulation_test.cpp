#include "runtime/simulate/simulation.h"

#include "tests/unit/runtime/hand_written_models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tf::runtime {
namespace {

struct LoggedEvent {
  double time;
  int kind;
  int element;
};

// A model with settings, run to points in time.
class Trajectory {
public:
  Trajectory(const tf_model &model, const std::vector<std::pair<std::string, double>> &settings, tf_integrator integrator,
             double tolerance = 1e-9)
      : instance_(model), inputs_(model.nu), simulation_(instance_, inputs_) {
    for (const auto &[name, value] : settings)
      EXPECT_TRUE(instance_.set(name, value).ok()) << name;
    simulation_.options.tolerance = tolerance;
    simulation_.options.integrator = integrator;
    simulation_.onEvent = [this](const tf_event &event) { events.push_back({event.time, event.kind, event.element}); };
  }

  void to(double time) {
    if (!started_) {
      ASSERT_EQ(simulation_.initialise(0), TF_OK) << simulation_.errorText();
      started_ = true;
    }
    ASSERT_EQ(simulation_.advanceTo(time), TF_OK) << simulation_.errorText();
  }

  double operator()(const std::string &name) {
    std::vector<double> all(instance_.model().variable_count);
    simulation_.values(all.data());
    const auto reference = instance_.find(name);
    EXPECT_TRUE(reference.has_value()) << name;
    return reference->sign * all[reference->variable];
  }

  [[nodiscard]] double eventTime(int kind) const {
    for (const LoggedEvent &event : events)
      if (event.kind == kind)
        return event.time;
    return -1;
  }

  Simulation &simulation() { return simulation_; }
  std::vector<LoggedEvent> events;

private:
  ModelInstance instance_;
  InputSignals inputs_;
  Simulation simulation_;
  bool started_ = false;
};

class EveryIntegrator : public testing::TestWithParam<tf_integrator> {};

INSTANTIATE_TEST_SUITE_P(Integrators, EveryIntegrator, testing::Values(TF_STEP, TF_EXPLICIT, TF_CVODE, TF_AUTO));

TEST_P(EveryIntegrator, FallsAndRests) {
  Trajectory run(test::particleModel(), {}, GetParam());
  run.to(0.4);
  EXPECT_NEAR(run("q[2]"), 1 - 0.5 * 9.81 * 0.16, 1e-9);
  run.to(1);
  EXPECT_NEAR(run("q[2]"), 0, 1e-10);
  EXPECT_NEAR(run("der(q[2])"), 0, 1e-10);
  EXPECT_NEAR(run("floor.normalForce"), 9.81, 1e-9);
  EXPECT_NEAR(run("tau"), 2, 1e-8);
  EXPECT_NEAR(run.eventTime(TF_EVENT_IMPACT), std::sqrt(2 / 9.81), 1e-8);
}

TEST_P(EveryIntegrator, SlipsThenSticks) {
  Trajectory run(test::particleModel(), {{"mu", 0.3}, {"g", 10}, {"u[1]", 2}, {"der(q[1])", 1}}, GetParam());
  run.to(2);
  EXPECT_NEAR(run("q[1]"), 0.8, 1e-7);
  EXPECT_NEAR(run("der(q[1])"), 0, 1e-9);
  EXPECT_NEAR(run("floor.frictionForce"), -2, 1e-9);
  EXPECT_NEAR(run.eventTime(TF_EVENT_STICK), 1, 1e-8);
}

// CVODE is initialised anew at each event: the numbers of before are kept.
TEST(SimulationStatistics, CountTheWorkOfCvode) {
  Trajectory run(test::beltModel(), {}, TF_CVODE);
  run.to(2);
  const tf_statistics &statistics = run.simulation().statistics();
  EXPECT_FALSE(run.events.empty());
  EXPECT_GT(statistics.jacobians, static_cast<int>(run.events.size()));
  EXPECT_GE(statistics.newton_iterations, statistics.steps);
  EXPECT_GE(statistics.evaluations, statistics.newton_iterations);
}

TEST_P(EveryIntegrator, BeltSticksThenSlips) {
  Trajectory run(test::beltModel(), {}, GetParam());
  run.to(2);
  EXPECT_NEAR(run.eventTime(TF_EVENT_SLIP), 5.0 / 6, 1e-8);
  EXPECT_NEAR(run("x"), 0.35846288226074874, 1e-7);
  EXPECT_NEAR(run("der(x)"), -0.2072274419249628, 1e-7);
}

TEST_P(EveryIntegrator, RelaySlides) {
  Trajectory run(test::relayModel(), {}, GetParam());
  run.to(3);
  EXPECT_NEAR(run.eventTime(TF_EVENT_SLIDING), 0.887862211570866, 1e-8);
  EXPECT_NEAR(run("x"), 0, 1e-9);
}

TEST_P(EveryIntegrator, RodReversesFrictionInsideTheImpact) {
  Trajectory run(test::rodModel(), {}, GetParam());
  run.to(1.5);
  EXPECT_NEAR(run("x"), 0.99319628269525095, 1e-7);
  EXPECT_NEAR(run("der(x)"), 0, 1e-9);
  EXPECT_NEAR(run.eventTime(TF_EVENT_IMPACT), 0.31927542840705037, 1e-8);
}

// Pulled by F along x against friction R = μ m g, speed w at the angle ψ to x: dw/dψ = w (R/F − cos ψ)/sin ψ, so that for R = 2F
// w = C tan²(ψ/2)/sin ψ and dt = −w dψ/(F sin ψ): rest at t = C/(2F) (u + u³/3), u = tan(ψ₀/2). The direction tends to that of the force.
TEST_P(EveryIntegrator, SlidesOnACurveToRest) {
  for (const double tolerance : {1e-6, 1e-9}) {
    Trajectory run(test::particle3dModel(), {{"mu", 0.2}, {"g", 10}, {"u[1]", 1}, {"der(q[1])", 2}, {"der(q[2])", 1}}, GetParam(),
                   tolerance);
    run.to(3);
    const double angle = std::atan2(1, 2), u = std::tan(angle / 2), C = std::sqrt(5) * std::sin(angle) / (u * u);
    const auto x = [&](double psi) {
      const double w = psi > 0 ? C * std::pow(std::tan(psi / 2), 2) / std::sin(psi) : 0;
      return psi > 0 ? w * w * std::cos(psi) / std::sin(psi) : 0;
    };
    double position = 0;  // by Simpson's rule
    constexpr int parts = 2000;
    for (int k = 0; k <= parts; ++k)
      position += x(angle * k / parts) * (k == 0 || k == parts ? 1 : k % 2 == 1 ? 4 : 2) * angle / (3 * parts);
    EXPECT_NEAR(run.eventTime(TF_EVENT_STICK), C / 2 * (u + u * u * u / 3), 10 * tolerance);
    EXPECT_NEAR(run("q[1]"), position, 10 * tolerance);
    EXPECT_NEAR(run("der(q[1])"), 0, 1e-13);
    EXPECT_NEAR(run("der(q[2])"), 0, 1e-13);
    EXPECT_NEAR(run("floor.frictionForce[1]"), -1, 1e-9);
    EXPECT_EQ(run("floor.sticking"), 1);
  }
}

TEST_P(EveryIntegrator, SticksInThePlaneWithoutCreep) {
  Trajectory run(test::particle3dModel(), {{"mu", 0.5}, {"g", 10}, {"u[1]", 3}, {"u[2]", -3.9}, {"der(q[1])", 0}, {"der(q[2])", 0}},
                 GetParam());
  run.to(1000);
  EXPECT_EQ(run("q[1]"), 0);
  EXPECT_EQ(run("q[2]"), 0);
  EXPECT_NEAR(run("floor.frictionForce[2]"), 3.9, 1e-12);
}

TEST_P(EveryIntegrator, SlipStartsAlongThePull) {
  Trajectory run(test::particle3dModel(), {{"mu", 0.5}, {"g", 10}, {"u[1]", 3}, {"u[2]", -4.1}, {"der(q[1])", 0}, {"der(q[2])", 0}},
                 GetParam());
  run.to(1);
  const double pull = std::hypot(3, 4.1), acceleration = pull - 5;
  EXPECT_NEAR(run("der(q[1])"), acceleration * 3 / pull, 1e-8);
  EXPECT_NEAR(run("der(q[2])"), -acceleration * 4.1 / pull, 1e-8);
  EXPECT_NEAR(run("floor.frictionForce[1]"), -5 * 3 / pull, 1e-6);
}

TEST_P(EveryIntegrator, BoxComesToRest) {
  Trajectory run(test::boxModel(), {}, GetParam());
  run.to(2);
  EXPECT_NEAR(run("x"), 2.3935779816513785, 1e-7);
  EXPECT_NEAR(run("y"), 0.5, 1e-9);
  EXPECT_NEAR(run("th"), 1.5707963267948966, 1e-9);
}

TEST(Simulation, RefusesNegativeFriction) {
  ModelInstance instance(test::beltModel());
  ASSERT_TRUE(instance.set("N", -2).ok());
  InputSignals inputs(instance.model().nu);
  Simulation simulation(instance, inputs);
  EXPECT_EQ(simulation.initialise(0), TF_FAILED);
  EXPECT_NE(simulation.errorText().find("bound of friction element 'dry' is -1"), std::string::npos) << simulation.errorText();
}

int switchingCalls = 0;

// A gap that opens from a little below zero, within the accuracy of events, is not looked into as one that may dip below zero.
TEST(Simulation, SamplesNoGapThatOpensBelowZero) {
  static tf_model counting = test::rodModel();
  static const auto original = counting.switching;
  counting.switching = [](const double *const *in, double *const *out, const std::uint8_t *mask) {
    ++switchingCalls;
    original(in, out, mask);
  };
  constexpr double depth = 5e-11, angle = 0.3, spin = 1e-3, speed = 1e-8;
  const double height = 0.5 * std::sin(angle) - depth, rise = 0.5 * std::cos(angle) * spin + speed;
  Trajectory rod(counting, {{"g", 0}, {"y", height}, {"th", angle}, {"der(y)", rise}, {"der(th)", spin}}, TF_EXPLICIT, 1e-6);
  switchingCalls = 0;
  rod.to(1e-3);
  EXPECT_TRUE(rod.events.empty());
  EXPECT_LT(switchingCalls, 100);
}

}  // namespace
}  // namespace tf::runtime
