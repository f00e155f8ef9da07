// Coefficients of friction that depend on time and place: they may be zero for a while or for an instant, and begin and end with a switch.
#include "tests/accuracy/each_integrator.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <stdexcept>
#include <string>

namespace tf::test {
namespace {

constexpr double pi = std::numbers::pi;

// A block of mass 1 on a floor, gravity 10, with a force F0 + F1 t along it.
std::string block(const std::string &name, const std::string &friction, bool inSpace = false) {
  const std::string across = inSpace ? ", w" : "", slip = inSpace ? "{der(x), der(w)}" : "der(x)", zero = inSpace ? ", 0" : "";
  return sourceFile(name + ".tf", "model Block\n  parameter Real F0 = 0, F1 = 0;\n  coordinate Real x" + across +
                                      ", y;\n  body b(mass = 1, position = {x" + across + ", y});\n  gravity g(acceleration = {0" + zero +
                                      ", -10});\n  force f(at = x, value = F0 + F1*time);\n  contact c(gap = y, slip = " + slip +
                                      ", friction = " + friction + ");\nend Block;\n");
}

// The block's speed at time 1.
void expectSpeed(const std::string &name, const std::string &friction, const Settings &settings, double speed) {
  for (const bool inSpace : {false, true}) {
    SCOPED_TRACE(inSpace ? name + " in space" : name);
    withEachIntegrator(
        block(inSpace ? name + "_in_space" : name, friction, inSpace), 1e-9, 1,
        [&](const CompiledModel &model) { EXPECT_NEAR(model["der(x)"], speed, 2e-8); }, settings);
  }
}

const Settings thrown = {{"der(x)", 3}};

TEST(VaryingFriction, GrowsFromZero) {
  expectSpeed("growing", "0.3*time", thrown, 1.5);
  expectSpeed("growing_slowly", "0.3*time^2", thrown, 2);
}

// From x = 1 on an oscillation of ω² = 0.3·10.
TEST(VaryingFriction, BeginsAtAPlace) {
  const double omega = std::sqrt(3.0);
  withEachIntegrator(
      block("beginning", "max(0, 0.3*(x - 1))"), 1e-9, 1,
      [&](const CompiledModel &model) {
        EXPECT_NEAR(model["x"], 1 + 3 / omega * std::sin(omega * 2 / 3), 1e-8);
        EXPECT_NEAR(model["der(x)"], 3 * std::cos(omega * 2 / 3), 1e-8);
      },
      thrown);
}

// dv²/dx = −2 μ g.
TEST(VaryingFriction, EndsAtAPlace) {
  expectSpeed("ending", "max(0, 0.3*(1 - x))", thrown, std::sqrt(6.0));
  expectSpeed("ending_by_if", "if x < 1 then 0.3*(1 - x) else 0", thrown, std::sqrt(6.0));
}

TEST(VaryingFriction, EndsAtATime) { expectSpeed("ending_in_time", "if time < 0.5 then 0.5 - time else 0", thrown, 1.75); }

// Zero at some places only: ∫ |sin 5x| over three halves of a period is 6/5.
TEST(VaryingFriction, VanishesForAnInstant) {
  withEachIntegrator(
      block("vanishing", "0.3*abs(sin(5*x))"), 1e-9, 1,
      [](const CompiledModel &model) {
        const double phase = 5 * model["x"] - 3 * pi;
        ASSERT_GT(phase, 0);
        ASSERT_LT(phase, pi);
        EXPECT_NEAR(model["der(x)"], std::sqrt(9 - 2 * 3 * (1.2 + (1 - std::cos(phase)) / 5)), 1e-8);
      },
      thrown);
}

// The coefficient has a square root of the place: its branch cannot be evaluated beyond the place where it ends.
TEST(VaryingFriction, EndsWithASquareRoot) {
  withEachIntegrator(
      block("root", "0.3*sqrt(max(0, 1 - x))"), 1e-9, 1,
      [](const CompiledModel &model) { EXPECT_NEAR(model["der(x)"], std::sqrt(9 - 4.0), 1e-7); }, thrown);
}

TEST(VaryingFriction, HoldsABlockFromZeroOn) {
  expectSpeed("holding", "0.3*time", {}, 0);
  expectSpeed("holding_a_force", "0.3*time", {{"F1", 1}}, 0);
  expectSpeed("yielding", "0.3*time", {{"F1", 4}}, 0.5);
  // v = t − 3/2 t² until t = 2/3.
  expectSpeed("stopping", "0.3*time", {{"F0", 1}}, 0);
  CompiledModel model(block("stopping", "0.3*time"), {{"F0", 1}});
  model.tolerance(1e-9).run(1);
  EXPECT_NEAR(model["x"], 2.0 / 27, 1e-9);
}

// Without a switch the model is wrong: the run ends where the coefficient passes zero.
TEST(VaryingFriction, BelowZeroEndsTheRun) {
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(block("negative", "0.1 + 0.2*sin(3*x)"), thrown);
    model.tolerance(1e-9).integrator(integrator);
    try {
      model.run(1);
      FAIL() << "no error";
    } catch (const std::runtime_error &error) {
      EXPECT_NE(std::string(error.what()).find("friction coefficient of contact 'c'"), std::string::npos) << error.what();
    }
    EXPECT_NEAR(3 * model["x"], 7 * pi / 6, 1e-6);
    EXPECT_GT(model["x"], 1);
  }
}

}  // namespace
}  // namespace tf::test
