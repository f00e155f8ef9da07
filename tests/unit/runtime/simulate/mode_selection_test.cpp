// Modes that are selected begin with what the selection has assembled and solved.
#include "runtime/simulate/mode_selection.h"

#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace tf::runtime {
namespace {

// The box on its lower left corner, or flat on both lower corners (angle 0), which move with the given slip.
struct Box {
  Box() : instance(test::boxModel()), inputs(test::boxModel().nu), at(test::boxModel(), inputs), dynamics(at), selection(dynamics) {
    EXPECT_TRUE(at.setParameters(instance.parameters().data()));
    at.setSegment(0.5);
    open.closed.assign(test::boxModel().nc, 0);
    open.tangent.assign(test::boxModel().nt, Tangent::None);
  }

  static std::vector<double> state(double angle, double slip) {
    const double x = -0.5 * std::cos(angle) + 0.3 * std::sin(angle), y = -0.5 * std::sin(angle) - 0.3 * std::cos(angle);
    const double spin = angle == 0 ? 0 : 0.4;
    return {0.1, -y, angle, slip + spin * y, -spin * x, spin, 0};
  }
  std::vector<double> guards() {
    std::vector<double> values(dynamics.guards().size());
    dynamics.guardValues(values.data());
    return values;
  }

  ModelInstance instance;
  InputSignals inputs;
  ModelEvaluation at;
  ModeDynamics dynamics;
  ModeSelection selection;
  Mode open;
};

// Corner and face, sliding, sticking and about to slip, redundant where the face sticks.
TEST(ModeSelection, ModesBeginWithTheForcesOfTheSelection) {
  for (const double angle : {0.3, 0.0})
    for (const double slip : {0.7, 0.0, -0.7}) {
      SCOPED_TRACE(testing::Message() << "angle " << angle << ", slip " << slip);
      Box box;
      const std::vector<double> state = Box::state(angle, slip);
      const Selection &selected = box.selection.select(0, state.data(), box.open);
      ASSERT_EQ(selected.status, SelectionStatus::Selected);
      EXPECT_EQ(selected.mode.closed[0], 1);
      const std::vector<double> rate = box.selection.rate(), normal = box.at.normalForce, tangent = box.at.tangentForce;
      const std::vector<double> guards = box.guards();
      Box other;
      std::vector<double> expected(state.size());
      ASSERT_TRUE(other.dynamics.start(selected.mode, 0, state.data(), expected.data()));
      EXPECT_EQ(rate, expected);
      EXPECT_EQ(normal, other.at.normalForce);
      EXPECT_EQ(tangent, other.at.tangentForce);
      EXPECT_EQ(guards, other.guards());
      // The mode that goes on is no other one either.
      std::vector<double> later = state, laterRate(state.size()), laterExpected(state.size());
      later[2] += 1e-3;
      ASSERT_TRUE(box.dynamics.evaluate(0.01, later.data(), laterRate.data()));
      ASSERT_TRUE(other.dynamics.evaluate(0.01, later.data(), laterExpected.data()));
      EXPECT_EQ(laterRate, laterExpected);
    }
}

// A run that fails within an event leaves a mode behind that is held for a projection only.
TEST(ModeSelection, AModeThatIsHeldOnlyHasForcesOfItsOwn) {
  Box box, other;
  std::vector<double> state = Box::state(0.3, 0.7), rate(state.size()), expected(state.size());
  ASSERT_EQ(box.selection.select(0, state.data(), box.open).status, SelectionStatus::Selected);
  state = Box::state(0, 0.7);
  const Mode flat = other.selection.select(0, state.data(), other.open).mode;
  ASSERT_GT(std::count(flat.closed.begin(), flat.closed.end(), 1), 1);
  ASSERT_TRUE(other.dynamics.evaluate(0, state.data(), expected.data()));
  ASSERT_TRUE(box.dynamics.hold(flat, 0, state.data()));
  ASSERT_TRUE(box.dynamics.evaluate(0, state.data(), rate.data()));
  for (std::size_t k = 0; k < rate.size(); ++k)
    EXPECT_NEAR(rate[k], expected[k], 1e-12) << k;
}

// What was found for one state is nothing for the next one.
TEST(ModeSelection, ForcesAreThoseOfTheState) {
  Box box;
  std::vector<double> rate;
  for (const double slip : {0.7, 0.2, 0.0, -0.7, 0.0, 0.7}) {
    for (const double angle : {0.0, 0.3, 0.25}) {
      SCOPED_TRACE(testing::Message() << "angle " << angle << ", slip " << slip);
      const std::vector<double> state = Box::state(angle, slip);
      const Selection &selected = box.selection.select(0, state.data(), box.open);
      ASSERT_EQ(selected.status, SelectionStatus::Selected);
      Box other;
      std::vector<double> expected(state.size());
      ASSERT_TRUE(other.dynamics.start(selected.mode, 0, state.data(), expected.data()));
      EXPECT_EQ(box.selection.rate(), expected);
    }
  }
}

}  // namespace
}  // namespace tf::runtime
