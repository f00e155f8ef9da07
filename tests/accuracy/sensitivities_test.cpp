// Sensitivities across impacts, stick and slip: against closed forms, and against differences of whole runs.
#include "tests/accuracy/compiled_model.h"

#include <cmath>
#include <gtest/gtest.h>
#include <ostream>

namespace tf::test {
namespace {

void differentiateBy(CompiledModel &model, const std::vector<const char *> &names) {
  ASSERT_EQ(tf_set_sensitivities(model.simulation(), names.data(), names.size()), TF_OK) << tf_error_text(model.simulation());
}

double sensitivity(CompiledModel &model, const std::string &variable, std::size_t column) {
  std::vector<double> all(static_cast<std::size_t>(model.model().variable_count));
  EXPECT_EQ(tf_get_sensitivity(model.simulation(), column, all.data()), TF_OK) << tf_error_text(model.simulation());
  return all[static_cast<std::size_t>(tf_find(model.simulation(), variable.c_str()))];
}

// Falls from h with the speed v along a rough floor: impact at t1 = sqrt(2h/g), which takes mu·g·t1 of v, then sliding friction mu·g, rest
// at t2 = v/(mu g), x = v t1 + (v − mu g t1)²/(2 mu g).
TEST(Sensitivities, OfASlideAfterAnImpactAreThoseOfTheClosedForm) {
  const double h = 1, g = 9.81, mu = 0.3, v = 2, t1 = std::sqrt(2 * h / g), after = v - mu * g * t1;
  CompiledModel model(TF_SOURCE_DIR "/tests/accuracy/contract/particle.tf", {{"mu", mu}, {"der(q[1])", v}});
  differentiateBy(model, {"mu", "q[2]", "der(q[1])", "g"});
  model.tolerance(1e-10).initialise();
  model.advance(1.5);
  EXPECT_EQ(model["der(q[1])"], 0);
  EXPECT_NEAR(sensitivity(model, "q[1]", 0), -t1 * after / mu - after * after / (2 * mu * mu * g), 1e-8);
  const double byTime = v - after;  // dx/dt1
  EXPECT_NEAR(sensitivity(model, "q[1]", 1), byTime * t1 / (2 * h), 1e-8);
  EXPECT_NEAR(sensitivity(model, "q[1]", 2), t1 + after / (mu * g), 1e-8);
  EXPECT_NEAR(sensitivity(model, "q[1]", 3), -byTime * t1 / (2 * g) - t1 * after / g - after * after / (2 * mu * g * g), 1e-8);
  for (std::size_t column = 0; column < 4; ++column) {
    EXPECT_NEAR(sensitivity(model, "der(q[1])", column), 0, 1e-9);
    EXPECT_NEAR(sensitivity(model, "q[2]", column), 0, 1e-9);
  }
  EXPECT_NEAR(sensitivity(model, "floor.normalForce", 3), 1, 1e-9);
}

TEST(Sensitivities, AnInputIsAConstantAddedToIt) {
  CompiledModel model(TF_SOURCE_DIR "/tests/accuracy/contract/particle.tf", {{"mu", 0}});
  differentiateBy(model, {"u[1]", "m"});
  model.tolerance(1e-10).initialise();
  model.advance(0.4);
  EXPECT_NEAR(sensitivity(model, "q[1]", 0), 0.08, 1e-10);
  EXPECT_NEAR(sensitivity(model, "q[2]", 1), 0, 1e-10);
}

TEST(Sensitivities, NamesOfResultsAreRefused) {
  CompiledModel model(TF_SOURCE_DIR "/tests/accuracy/contract/particle.tf");
  for (const char *name : {"floor.normalForce", "no such thing"})
    EXPECT_EQ(tf_set_sensitivities(model.simulation(), &name, 1), TF_BAD_ARGUMENT);
  std::vector<double> all(static_cast<std::size_t>(model.model().variable_count));
  model.initialise();
  EXPECT_EQ(tf_get_sensitivity(model.simulation(), 0, all.data()), TF_BAD_ARGUMENT);
}

struct Case {
  const char *file;
  double time;
  const char *name;
  double value;
};

std::ostream &operator<<(std::ostream &out, const Case &c) { return out << c.file << " by " << c.name << " at " << c.time; }

class RunDifferences : public testing::TestWithParam<Case> {};

std::vector<double> states(CompiledModel &model) {
  std::vector<double> all = model.valuesOf(TF_KIND_COORDINATE);
  const std::vector<double> velocities = model.valuesOf(TF_KIND_VELOCITY);
  all.insert(all.end(), velocities.begin(), velocities.end());
  return all;
}

TEST_P(RunDifferences, Agree) {
  const Case &c = GetParam();
  const double h = 1e-5;
  const auto run = [&](double value) {
    CompiledModel model(example(c.file), {{c.name, value}});
    model.tolerance(1e-12).initialise();
    model.advance(c.time);
    return states(model);
  };
  const std::vector<double> plus = run(c.value + h), minus = run(c.value - h);
  CompiledModel model(example(c.file), {{c.name, c.value}});
  differentiateBy(model, {c.name});
  model.tolerance(1e-10).initialise();
  model.advance(c.time);
  std::vector<double> all(static_cast<std::size_t>(model.model().variable_count));
  ASSERT_EQ(tf_get_sensitivity(model.simulation(), 0, all.data()), TF_OK) << tf_error_text(model.simulation());
  for (std::int32_t k = 0; k < model.model().variable_count; ++k) {
    const tf_variable &variable = model.model().variables[k];
    const bool isVelocity = variable.kind == TF_KIND_VELOCITY;
    if (!isVelocity && variable.kind != TF_KIND_COORDINATE)
      continue;
    const auto place = static_cast<std::size_t>(variable.index + (isVelocity ? model.model().nq : 0));
    const double expected = (plus[place] - minus[place]) / (2 * h);
    EXPECT_NEAR(all[static_cast<std::size_t>(k)], expected, 2e-7 * std::max(1.0, std::abs(expected))) << variable.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Examples, RunDifferences,
                         testing::Values(Case{"falling_rod.tf", 0.6, "mu", 0.3}, Case{"falling_rod.tf", 1.4, "phi", 0.785},
                                         Case{"falling_box.tf", 0.9, "der(r[1])", 3}, Case{"stickslip.tf", 3, "mu", 0.5},
                                         Case{"stickslip.tf", 3, "k", 4}, Case{"chain.tf", 0.4, "mu", 0.5},
                                         Case{"chain.tf", 0.4, "r[2]", 0.3}));

}  // namespace
}  // namespace tf::test
