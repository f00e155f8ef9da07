// Runs that go on from a saved state as the run that saved it does.
#include "tests/accuracy/support/compiled_model.h"

#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <vector>

namespace tf::test {
namespace {

std::vector<char> save(CompiledModel &model) {
  std::vector<char> state(tf_state_size(model.simulation()));
  EXPECT_EQ(tf_save_state(model.simulation(), state.data(), state.size()), TF_OK) << tf_error_text(model.simulation());
  return state;
}

tf_status restore(CompiledModel &model, const std::vector<char> &state) {
  return tf_restore_state(model.simulation(), state.data(), state.size());
}

// The bits of all variables: some are no numbers.
std::vector<std::uint64_t> all(CompiledModel &model) {
  std::vector<double> values(static_cast<std::size_t>(model.model().variable_count));
  EXPECT_EQ(tf_get_all(model.simulation(), values.data()), TF_OK);
  std::vector<std::uint64_t> bits(values.size());
  std::memcpy(bits.data(), values.data(), values.size() * sizeof(double));
  return bits;
}

// A block that its friction holds, 5 N at most, and a relay: both change with the input at once.
std::string heldBlock() {
  return sourceFile("held_block.tf", R"(
model A
  input Real u;
  coordinate Real x, y;
  Real z(start = 0);
  body b(mass = 1, position = {x, y});
  gravity g(acceleration = {0, -10});
  force f(value = u, at = x);
  contact c(gap = y, slip = der(x), friction = 0.5);
equation
  der(z) = if u > 1 then 1 else 0;
end A;
)");
}

TEST(SavedStates, HoldInputsThatTheModeHasNotTakenYet) {
  for (const tf_integrator integrator : integrators)
    for (const double at : {0.0, 0.5}) {
      CompiledModel run(heldBlock()), fresh(heldBlock());
      for (CompiledModel *model : {&run, &fresh}) {
        model->integrator(integrator);
        model->initialise();
      }
      run.advance(at);
      ASSERT_EQ(tf_set(run.simulation(), "u", 8), TF_OK);
      const std::vector<char> state = save(run);
      run.advance(at + 1);
      EXPECT_NEAR(run["x"], 1.5, 1e-7);
      EXPECT_NEAR(run["z"], 1, 1e-7);
      const std::vector<std::uint64_t> expected = all(run);
      for (CompiledModel *model : {&fresh, &run}) {
        ASSERT_EQ(restore(*model, state), TF_OK) << tf_error_text(model->simulation());
        model->advance(at + 1);
        EXPECT_EQ(all(*model), expected);
      }
    }
}

// The caller's tables are not in the state: those of the restored run may have other values.
TEST(SavedStates, GoOnWithTheTablesThatTheRunHas) {
  CompiledModel run(heldBlock()), other(heldBlock());
  const auto setTable = [](CompiledModel &model, double value) {
    const double times[] = {0, 10}, values[] = {value, value + 1};
    ASSERT_EQ(tf_set_input_table(model.simulation(), "u", times, values, 2, 1), TF_OK) << tf_error_text(model.simulation());
  };
  setTable(run, 0);
  setTable(other, 8);
  run.initialise();
  other.initialise();
  run.advance(0.5);
  const std::vector<char> state = save(run);
  ASSERT_EQ(restore(other, state), TF_OK) << tf_error_text(other.simulation());
  other.advance(1.5);
  // ∫∫ (3 + (0.5 + s)/10) ds
  EXPECT_NEAR(other["x"], 1.5 + 0.025 + 1.0 / 60, 1e-10);
  EXPECT_NEAR(other["z"], 1, 1e-10);
  ASSERT_EQ(restore(run, state), TF_OK) << tf_error_text(run.simulation());
  run.advance(1.5);
  EXPECT_EQ(run["x"], 0);
}

TEST(SavedStates, OfRunsThatHaveFailedGoOnWithOtherInputs) {
  const std::string file = sourceFile("failed_block.tf", R"(
model A
  input Real mu(start = 0.2);
  coordinate Real x(der(start = 3)), y;
  body b(mass = 1, position = {x, y});
  gravity g(acceleration = {0, -10});
  contact floor(gap = y, slip = der(x), friction = mu);
end A;
)");
  CompiledModel run(file), fresh(file);
  for (CompiledModel *model : {&run, &fresh})
    model->initialise();
  run.advance(0.5);
  ASSERT_EQ(tf_set(run.simulation(), "mu", -1), TF_OK);
  EXPECT_THROW(run.advance(1), std::runtime_error);
  const std::vector<char> state = save(run);
  std::vector<std::vector<std::uint64_t>> results;
  for (CompiledModel *model : {&run, &fresh, &run}) {
    if (!results.empty()) {
      ASSERT_EQ(restore(*model, state), TF_OK) << tf_error_text(model->simulation());
    }
    EXPECT_THROW(model->advance(1), std::runtime_error);
    ASSERT_EQ(tf_set(model->simulation(), "mu", 0.4), TF_OK);
    model->advance(2);
    // From 2 m/s on 4 m/s².
    EXPECT_NEAR((*model)["x"], 1.25 + 0.5, 1e-10);
    results.push_back(all(*model));
  }
  EXPECT_EQ(results[1], results[0]);
  EXPECT_EQ(results[2], results[0]);
}

TEST(SavedStates, AreRefusedByRunsWithOtherSensitivities) {
  CompiledModel byForce(heldBlock()), byStart(heldBlock()), both(heldBlock()), reversed(heldBlock());
  const auto differentiate = [](CompiledModel &model, std::vector<const char *> names) {
    ASSERT_EQ(tf_set_sensitivities(model.simulation(), names.data(), names.size()), TF_OK) << tf_error_text(model.simulation());
    model.initialise();
    model.advance(0.5);
  };
  differentiate(byForce, {"u"});
  differentiate(byStart, {"der(x)"});
  differentiate(both, {"u", "z"});
  differentiate(reversed, {"z", "u"});
  EXPECT_EQ(restore(byForce, save(byForce)), TF_OK);
  EXPECT_EQ(restore(byStart, save(byForce)), TF_BAD_ARGUMENT);
  EXPECT_EQ(restore(reversed, save(both)), TF_BAD_ARGUMENT);
}

// Values before events are evaluated for a callback only: what is sought after the event begins at the same forces without.
TEST(EventCallbacks, ChangeNothing) {
  const std::string file = sourceFile("watched_box.tf", R"(
model WatchedBox
  parameter Real h[3] = {0.3, 0.2, 0.15};
  parameter Real s[8, 3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
  coordinate Real p[3](start = {0, 0, 0.6}, der(start = {3, 0.3, 0}));
  coordinate Rotation Q(start = {0.9, 0.2, -0.3, 0.1}, w(start = {0.5, 4, 2}));
  Real corner[8, 3] = {p + Q*{s[i, j]*h[j] for j in 1:3} for i in 1:8};
  body box(mass = 1, position = p, orientation = Q, inertia = 1/3*diagonal({h[2]^2 + h[3]^2, h[1]^2 + h[3]^2, h[1]^2 + h[2]^2}));
  gravity weight(acceleration = {0, 0, -9.81});
  contact floor[8](gap = corner[:, 3], slip = der(corner[:, 1:2]), each friction = 0.3, each restitution = 0.4);
end WatchedBox;
)");
  for (const tf_integrator integrator : {TF_AUTO, TF_STEP})
    for (int start = 0; start < 20; ++start) {
      const auto run = [&](bool isWatched) {
        CompiledModel model(file);
        if (!isWatched)
          tf_set_event_callback(model.simulation(), nullptr, nullptr);
        model.tolerance(1e-4).integrator(integrator).initialise();
        for (double time = 0.02 * (start + 1); time < 1.3; time += 0.11 + 0.003 * start)
          model.advance(time);
        model.advance(1.3);
        std::vector<double> end = model.valuesOf(TF_KIND_COORDINATE);
        end.push_back(model["tau"]);
        return end;
      };
      EXPECT_EQ(run(true), run(false)) << integrator << ", " << start;
    }
}

}  // namespace
}  // namespace tf::test
