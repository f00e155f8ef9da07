// The forces of small modes with the friction folded into the columns: the same as those of all rows, and nothing allocated in a step.
#include "runtime/integrate/dormand_prince.h"
#include "runtime/integrate/element_integrator.h"
#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/allocation_counter.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>

namespace tf::runtime {
namespace {

// The box on its lower left corner, or flat on both lower corners (angle 0).
struct Box {
  Box(double angle, double slip, Tangent tangent)
      : instance(test::boxModel()), inputs(test::boxModel().nu), at(test::boxModel(), inputs), dynamics(at) {
    const double x = -0.5 * std::cos(angle) + 0.3 * std::sin(angle), y = -0.5 * std::sin(angle) - 0.3 * std::cos(angle);
    const double spin = angle == 0 ? 0 : 0.4;
    state = {0.1, -y, angle, slip + spin * y, -spin * x, spin, 0};
    const bool flat = angle == 0;
    mode.closed = {1, static_cast<std::uint8_t>(flat), 0, 0};
    mode.tangent = {tangent, flat ? tangent : Tangent::None, Tangent::None, Tangent::None};
    EXPECT_TRUE(at.setParameters(instance.parameters().data()));
    at.setSegment(0.5);
  }

  ModelInstance instance;
  InputSignals inputs;
  ModelEvaluation at;
  ModeDynamics dynamics;
  std::vector<double> state;
  Mode mode;
};

void expectSameForces(Box &box) {
  const int n = box.dynamics.size();
  std::vector<double> all(n), folded(n);
  // The mode begins with the equations of all rows and goes on with folded ones.
  ASSERT_TRUE(box.dynamics.start(box.mode, 0, box.state.data(), all.data()));
  const std::vector<double> normal = box.at.normalForce, tangent = box.at.tangentForce;
  std::vector<double> guards(box.dynamics.guards().size()), foldedGuards(guards.size());
  box.dynamics.guardValues(guards.data());
  ASSERT_TRUE(box.dynamics.evaluate(0, box.state.data(), folded.data()));
  box.dynamics.guardValues(foldedGuards.data());
  for (int i = 0; i < n; ++i)
    EXPECT_NEAR(folded[i], all[i], 1e-12 * (1 + std::abs(all[i]))) << i;
  for (std::size_t i = 0; i < normal.size(); ++i) {
    EXPECT_NEAR(box.at.normalForce[i], normal[i], 1e-12 * (1 + normal[i])) << i;
    EXPECT_NEAR(box.at.tangentForce[i], tangent[i], 1e-12 * (1 + normal[i])) << i;
  }
  for (std::size_t k = 0; k < guards.size(); ++k)
    EXPECT_NEAR(foldedGuards[k], guards[k], 1e-11) << k;
  EXPECT_GT(normal[0], 0);
}

TEST(FoldedForces, OfASlidingCornerAreThoseOfAllRows) {
  Box box(0.3, 0.7, Tangent::SlipPositive);
  expectSameForces(box);
}

TEST(FoldedForces, OfAStickingCornerAreThoseOfAllRows) {
  Box box(0.3, 0, Tangent::Stick);
  expectSameForces(box);
}

// Friction that depends on parameters only is read once in a mode, but anew where these change, as for derivatives by them.
TEST(FoldedForces, ReadFrictionAnewWhereParametersChange) {
  Box box(0.3, 0.7, Tangent::SlipPositive), other(0.3, 0.7, Tangent::SlipPositive);
  std::vector<double> rate(box.state.size()), expected = rate, first = rate;
  ASSERT_TRUE(box.dynamics.start(box.mode, 0, box.state.data(), rate.data()));
  ASSERT_TRUE(box.dynamics.evaluate(0, box.state.data(), first.data()));
  ASSERT_TRUE(other.instance.set("mu", 0.1).ok());
  ASSERT_TRUE(other.at.setParameters(other.instance.parameters().data()));
  ASSERT_TRUE(other.dynamics.start(other.mode, 0, other.state.data(), rate.data()));
  ASSERT_TRUE(other.dynamics.evaluate(0, other.state.data(), expected.data()));
  ASSERT_NE(first, expected);
  ASSERT_TRUE(box.at.setParameters(other.instance.parameters().data()));
  ASSERT_TRUE(box.dynamics.evaluate(0, box.state.data(), rate.data()));
  EXPECT_EQ(rate, expected);
  EXPECT_EQ(box.at.tangentForce, other.at.tangentForce);
  ASSERT_TRUE(box.at.setParameters(box.instance.parameters().data()));
  ASSERT_TRUE(box.dynamics.evaluate(0, box.state.data(), rate.data()));
  EXPECT_EQ(rate, first);
}

TEST(FoldedForces, OfTwoSlidingCornersAreThoseOfAllRows) {
  Box box(0, -0.7, Tangent::SlipNegative);
  expectSameForces(box);
}

// The state off the floor: onto it by the same least change in the metric of the mass matrix with the rows' own code and without.
TEST(FoldedForces, ProjectionsAreThoseOfAllRows) {
  for (const Tangent tangent : {Tangent::SlipPositive, Tangent::Stick}) {
    Box box(0.3, tangent == Tangent::Stick ? 0 : 0.7, tangent);
    const std::vector<double> scale(box.state.size(), 1.0);
    std::vector<double> rate(box.state.size()), moved = box.state;
    ASSERT_TRUE(box.dynamics.start(box.mode, 0, box.state.data(), rate.data()));
    moved[1] += 1e-7;
    moved[3] += 2e-7;
    moved[4] -= 1e-7;
    ASSERT_TRUE(box.dynamics.evaluate(0, moved.data(), rate.data()));
    std::vector<double> projected = moved;
    const double size = box.dynamics.project(0, projected.data(), scale.data());
    EXPECT_GT(size, 5e-8);
    box.at.setPoint(0, projected.data());
    box.at.switching();
    EXPECT_NEAR(box.at.gap[0], 0, 1e-14);
    EXPECT_NEAR(box.at.gapRate[0], 0, 1e-13);  // the rows are those before the coordinates have been moved
    if (tangent == Tangent::Stick) {
      EXPECT_NEAR(box.at.slip[0], 0, 1e-13);
    }
    // M Δv is a combination of the rows: nothing else has been moved.
    const double mass = box.at.massMatrix[0], inertia = box.at.massMatrix[8];
    const double change[] = {projected[3] - moved[3], projected[4] - moved[4], projected[5] - moved[5]};
    const double *normal = box.at.normal.data(), *slip = box.at.tangent.data();
    const double along = mass * change[1] / normal[1], across = mass * change[0] / slip[0];
    if (tangent != Tangent::Stick) {
      EXPECT_NEAR(change[0], 0, 1e-16);
    }
    EXPECT_NEAR(inertia * change[2], along * normal[2] + across * slip[2], 1e-12);
  }
}

TEST(ModeDynamics, SlipRatesAreTheDerivativesOfSlips) {
  constexpr double difference = 1e-6;
  for (const Tangent tangent : {Tangent::SlipPositive, Tangent::SlipNegative}) {
    Box box(0.3, tangent == Tangent::SlipPositive ? 0.7 : -0.7, tangent);
    std::vector<double> rate(box.state.size());
    ASSERT_TRUE(box.dynamics.start(box.mode, 0, box.state.data(), rate.data()));
    const auto slip = [](const Guard &guard) { return guard.kind == GuardKind::Slip; };
    const std::vector<Guard> &guards = box.dynamics.guards();
    const int guard = static_cast<int>(std::find_if(guards.begin(), guards.end(), slip) - guards.begin());
    ASSERT_LT(guard, static_cast<int>(guards.size()));
    const double slipRate = box.dynamics.slipRate(guard);
    const auto valueAfter = [&](double time) {
      std::vector<double> moved = box.state;
      for (std::size_t i = 0; i < moved.size(); ++i)
        moved[i] += time * rate[i];
      box.at.setPoint(time, moved.data());
      return box.dynamics.guardValue(guard);
    };
    EXPECT_NEAR(slipRate, (valueAfter(difference) - valueAfter(-difference)) / (2 * difference), 1e-7 * std::abs(slipRate));
    EXPECT_GT(std::abs(slipRate), 0.1);
  }
}

// As derivatives by parameters do: a constant mass matrix that changes within the mode.
TEST(FoldedForces, FollowTheParameters) {
  Box box(0.3, 0.7, Tangent::SlipPositive);
  std::vector<double> rate(box.state.size()), again(box.state.size());
  ASSERT_TRUE(box.dynamics.start(box.mode, 0, box.state.data(), rate.data()));
  std::vector<double> parameters(box.instance.parameters().begin(), box.instance.parameters().end());
  for (double &value : parameters)
    value *= 1.1;
  ASSERT_TRUE(box.at.setParameters(parameters.data()));
  ASSERT_TRUE(box.dynamics.evaluate(0, box.state.data(), rate.data()));
  ASSERT_TRUE(box.dynamics.start(box.mode, 0, box.state.data(), again.data()));
  // All but tau, whose contact rates are those of the mode's start.
  for (std::size_t i = 0; i + 1 < rate.size(); ++i)
    EXPECT_NEAR(rate[i], again[i], 1e-12 * (1 + std::abs(again[i]))) << i;
}

TEST(FoldedForces, OfFlightAreNone) {
  Box box(0.3, 0.7, Tangent::SlipPositive);
  box.mode = {{0, 0, 0, 0}, {Tangent::None, Tangent::None, Tangent::None, Tangent::None}, {}};
  std::vector<double> first(box.state.size()), again(box.state.size());
  ASSERT_TRUE(box.dynamics.start(box.mode, 0, box.state.data(), first.data()));
  ASSERT_TRUE(box.dynamics.evaluate(0, box.state.data(), again.data()));
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_NEAR(again[i], first[i], 1e-14) << i;
  EXPECT_NEAR(again[4], -9.81, 1e-13);
  EXPECT_EQ(again.back(), 1);
}

TEST(FoldedForces, StepsAllocateNothing) {
  Box box(0.3, 0.7, Tangent::SlipPositive);
  std::vector<double> rate(box.state.size());
  ASSERT_TRUE(box.dynamics.start(box.mode, 0, box.state.data(), rate.data()));
  IntegratorSettings settings;
  settings.scale.assign(box.state.size(), 1.0);
  ElementIntegrator integrator(box.dynamics, settings, std::make_unique<DormandPrince>(box.dynamics.size()));
  integrator.start(0, box.state.data(), rate.data(), 1e-3);
  std::vector<double> inside(box.state.size());
  const auto step = [&] {
    EXPECT_EQ(integrator.step(1), StepStatus::Done);
    box.dynamics.project(integrator.endTime(), integrator.end(), settings.scale.data());
    integrator.interpolate(0.5 * (integrator.beginTime() + integrator.endTime()), inside.data());
  };
  step();
  const long before = test::allocations;
  step();
  step();
  EXPECT_EQ(test::allocations - before, 0);
  const auto copy = std::make_unique<double>(1);
  EXPECT_EQ(test::allocations - before, 1);  // what is allocated is counted
}

}  // namespace
}  // namespace tf::runtime
