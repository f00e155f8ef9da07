// The order of explicit steps: high where the error ends them, low where outputs or events do.
#include "tests/accuracy/support/compiled_model.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace tf::test {
namespace {

// x'' = −x − x³ from x = 1: the period is 4 K/√2 with the complete elliptic integral K(k² = 1/4) by the arithmetic-geometric mean.
std::string spring() {
  return sourceFile("hardening_spring.tf", R"(
model Spring
  coordinate Real x(start = 1);
  body b(mass = 1, position = x);
  force f(value = -x - x^3, at = x);
end Spring;
)");
}

double period() {
  double a = 1, b = std::sqrt(0.75);
  for (int k = 0; k < 6; ++k) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return 4 * std::acos(0.0) / a / std::sqrt(2.0);
}

long long evaluations(double tolerance, int outputs, double *error) {
  CompiledModel model(spring());
  model.tolerance(tolerance).integrator(TF_EXPLICIT).initialise();
  const double end = 5 * period();
  for (int k = 1; k <= outputs; ++k)
    model.advance(end * k / outputs);
  *error = std::abs(model["x"] - 1) + std::abs(model["der(x)"]);
  return tf_get_statistics(model.simulation())->evaluations;
}

TEST(OrderOfSteps, IsHighWhereTheErrorEndsThem) {
  double loose = 0, tight = 0;
  const double ratio = static_cast<double>(evaluations(1e-8, 1, &tight)) / static_cast<double>(evaluations(1e-6, 1, &loose));
  // A hundredth of the error: 100^(1/5) = 2.5 of order 5, 100^(1/8) = 1.8 of order 8.
  EXPECT_LT(ratio, 2.1);
  EXPECT_LT(loose, 1e-4);
  EXPECT_LT(tight, 1e-6);
}

TEST(OrderOfSteps, IsLowWhereOutputsEndThem) {
  for (const double tolerance : {1e-6, 1e-7}) {
    double error = 0;
    EXPECT_LT(evaluations(tolerance, 1000, &error), 7 * 1000);
    EXPECT_LT(error, 100 * tolerance);
  }
}

// A homogeneous ball that rolls on a turntable goes round in circles, at 2/7 of the table's rate: its slip of two components stays zero.
TEST(OrderOfSteps, IsHighWhereABallRolls) {
  CompiledModel model(sourceFile("turntable.tf", R"(
model Turntable
  parameter Real W = 3, r = 0.1;
  coordinate Real p[3](start = {0.4, 0.1, r}, der(start = {0.3, -0.2, 0}));
  coordinate Rotation Q(w(start = {(0.4*W + 0.2)/r, (0.3 + 0.1*W)/r, 1.3}));
  Real w[3] = Q*Q.w;
  body ball(mass = 0.7, position = p, orientation = Q, inertia = 2/5*0.7*r^2*identity(3));
  gravity g(acceleration = {0, 0, -9.81});
  contact table(gap = p[3] - r, slip = {der(p[1]) - r*w[2] + W*p[2], der(p[2]) + r*w[1] - W*p[1]}, friction = 5);
end Turntable;
)"));
  const double round = 4 * std::acos(0.0) / (2.0 / 7 * 3);
  const auto evaluations = [&](double tolerance) {
    model.tolerance(tolerance).integrator(TF_EXPLICIT).run(round);
    EXPECT_NEAR(model["p[1]"], 0.4, 20 * tolerance);
    EXPECT_NEAR(model["p[2]"], 0.1, 20 * tolerance);
    return static_cast<double>(tf_get_statistics(model.simulation())->evaluations);
  };
  // 10000^(1/5) = 6.3, 10000^(1/8) = 3.2.
  const double loose = evaluations(1e-6);
  EXPECT_LT(evaluations(1e-10) / loose, 4.5);
}

// The squares of the errors of a force that is all but zero are zero. Its whole impulse is s √π.
TEST(OrderOfSteps, AForceThatGrowsOutOfNothingIsFollowed) {
  CompiledModel model(sourceFile("pulse.tf", R"(
model Pulse
  parameter Real s = 0.3;
  coordinate Real x;
  body b(mass = 1, position = x);
  force f(value = exp(-((time - 10)/s)^2), at = x);
end Pulse;
)"));
  for (const double width : {0.1, 0.2, 0.35})
    for (const double tolerance : {1e-9, 1e-10, 1e-12}) {
      ASSERT_EQ(tf_set(model.simulation(), "s", width), TF_OK);
      model.tolerance(tolerance).initialise();
      for (int k = 1; k <= 200; ++k)
        model.advance(0.1 * k);
      EXPECT_NEAR(model["der(x)"], width * std::sqrt(std::acos(-1.0)), 10 * tolerance);
    }
}

}  // namespace
}  // namespace tf::test
