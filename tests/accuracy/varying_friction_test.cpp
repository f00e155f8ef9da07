// Coefficients of friction that depend on time and place: they may be zero for a while or for an instant, and begin and end with a switch.
#include "tests/accuracy/constants.h"
#include "tests/accuracy/each_integrator.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <stdexcept>
#include <string>

namespace tf::test {
namespace {

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

const Settings thrownAtThree = {{"der(x)", 3}};

TEST(VaryingFriction, GrowsFromZero) {
  expectSpeed("growing", "0.3*time", thrownAtThree, 1.5);
  expectSpeed("growing_slowly", "0.3*time^2", thrownAtThree, 2);
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
      thrownAtThree);
}

// dv²/dx = −2 μ g.
TEST(VaryingFriction, EndsAtAPlace) {
  expectSpeed("ending", "max(0, 0.3*(1 - x))", thrownAtThree, std::sqrt(6.0));
  expectSpeed("ending_by_if", "if x < 1 then 0.3*(1 - x) else 0", thrownAtThree, std::sqrt(6.0));
}

TEST(VaryingFriction, EndsAtATime) { expectSpeed("ending_in_time", "if time < 0.5 then 0.5 - time else 0", thrownAtThree, 1.75); }

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
      thrownAtThree);
}

// The coefficient has a square root of the place: its branch cannot be evaluated beyond the place where it ends.
TEST(VaryingFriction, EndsWithASquareRoot) {
  withEachIntegrator(
      block("root", "0.3*sqrt(max(0, 1 - x))"), 1e-9, 1,
      [](const CompiledModel &model) { EXPECT_NEAR(model["der(x)"], std::sqrt(9 - 4.0), 1e-7); }, thrownAtThree);
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

// A mass under friction with a peak of width vs where its slip turns round, v = x' − A sin(ωt): v' = −sign(v) g(v) − A ω cos(ωt), which the
// classical Runge–Kutta method follows in steps of 2 µs that end where v does.
struct StribeckReference {
  static constexpr double amplitude = 1, omega = 60, width = 0.02, end = 2, step = 2e-6;
  double x = 0, v = 0, time = 0, side = -1;

  [[nodiscard]] double acceleration(double t, double slip) const {
    return -side * 9.81 * (0.1 + 0.2 * std::exp(-slip * slip / (width * width))) - amplitude * omega * std::cos(omega * t);
  }
  void advance(double h) {
    const double k1 = acceleration(time, v), k2 = acceleration(time + h / 2, v + h / 2 * k1);
    const double k3 = acceleration(time + h / 2, v + h / 2 * k2), k4 = acceleration(time + h, v + h * k3);
    const double integral = h * v + h * h / 6 * (k1 + k2 + k3);
    x += integral + amplitude / omega * (std::cos(omega * time) - std::cos(omega * (time + h)));
    v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    time += h;
  }
  void run() {
    while (time < end - 0.5 * step) {
      const StribeckReference before = *this;
      advance(step);
      if (v * side >= 0)
        continue;
      // The zero by Newton's method.
      double part = before.v / (before.v - v) * step;
      for (int k = 0; k < 4; ++k) {
        *this = before;
        advance(part);
        part -= v / acceleration(time, v);
      }
      v = 0;
      side = -side;
      advance(step - part);
    }
  }
};

TEST(VaryingFriction, MayHaveAPeakWhereTheSlipTurnsRound) {
  StribeckReference reference;
  reference.run();
  const double speed = reference.v + std::sin(reference.omega * reference.end);
  const std::string file = sourceFile("peak.tf", R"(model Peak
  coordinate Real x;
  body b(mass = 1, position = {x, 0});
  friction f(slip = der(x) - sin(60*time), bound = 9.81*(0.1 + 0.2*exp(-((der(x) - sin(60*time))/0.02)^2)));
end Peak;
)");
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-6, 1e-7, 1e-8, 1e-9}) {
      SCOPED_TRACE("integrator " + std::to_string(integrator) + ", tolerance " + std::to_string(tolerance));
      CompiledModel model(file);
      model.tolerance(tolerance).integrator(integrator).initialise();
      for (int k = 1; k <= 200; ++k)
        model.advance(0.01 * k);
      EXPECT_NEAR(model["x"], reference.x, 10 * tolerance);
      EXPECT_NEAR(model["der(x)"], speed, 10 * tolerance);
    }
}

// Without a switch the model is wrong: the run ends where the coefficient passes zero.
TEST(VaryingFriction, BelowZeroEndsTheRun) {
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(block("negative", "0.1 + 0.2*sin(3*x)"), thrownAtThree);
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
