// Slips of two components that turn until they stop: along a curve that the body cannot leave, and towards the direction of a side force.
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

constexpr double stopTolerances[] = {1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-11};

// The bob of a spherical pendulum slides round on a floor, a circle of radius r = L sin θ, pressed by N = m (g − v²/(r tan θ)): with
// V² = g r tan θ and k = μ g/V the speed is V tanh(k (T − t)). Friction that is not along the circle changes N.
TEST(StoppingSlips, OnACircleThatTheContactHolds) {
  const std::string file = sourceFile("bob_on_floor.tf", R"(
model BobOnFloor
  parameter Real L = 1, g = 9.81, mu = 0.2, theta0 = 0.6, v0 = 1.2;
  coordinate Real theta(start = theta0), phi(der(start = v0/(L*sin(theta0))));
  Real p[3] = L*{sin(theta)*cos(phi), sin(theta)*sin(phi), -cos(theta)};
  body b(mass = 1, position = p);
  gravity weight(acceleration = {0, 0, -g});
  contact floor(gap = p[3] + L*cos(theta0), slip = der(p[1:2]), friction = mu);
end BobOnFloor;
)");
  const double r = std::sin(0.6), V = std::sqrt(9.81 * r * std::tan(0.6)), k = 0.2 * 9.81 / V;
  for (const double v0 : {0.3, 1.2}) {
    const double stop = std::atanh(v0 / V) / k, angle = V / (k * r) * std::log(std::cosh(k * stop));
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : stopTolerances) {
        SCOPED_TRACE(testing::Message() << "v0 " << v0 << ", integrator " << integrator << ", tolerance " << tolerance);
        CompiledModel model(file, {{"v0", v0}});
        model.integrator(integrator).tolerance(tolerance).run(1);
        EXPECT_EQ(model.count(TF_EVENT_STICK), 1);
        EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), stop, std::max(10 * tolerance, 2e-11));
        EXPECT_NEAR(model["phi"], angle, std::max(10 * tolerance, 2e-11));
      }
  }
}

// A particle on a belt that speeds up and slows down, with a force across: its slip turns towards that force as it stops, the faster the
// slower it is. All integrators agree on the time at 1e-10.
TEST(StoppingSlips, UnderAForceAcross) {
  const std::string file = sourceFile("pushed_on_belt.tf", R"(
model PushedOnBelt
  coordinate Real p[3];
  Real belt = if time < 1 then 0 elseif time < 2 then 2*(time - 1) else 2 - (time - 2);
  body b(mass = 1, position = p);
  gravity weight(acceleration = {0, 0, -9.81});
  force f(value = {0, 1.5*sin(4*time), 0}, at = p);
  contact c(gap = p[3], slip = {der(p[1]) - belt, der(p[2])}, friction = 0.22);
end PushedOnBelt;
)");
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : stopTolerances) {
      SCOPED_TRACE(testing::Message() << "integrator " << integrator << ", tolerance " << tolerance);
      CompiledModel model(file);
      model.integrator(integrator).tolerance(tolerance).run(2.3);
      ASSERT_EQ(model.count(TF_EVENT_STICK), 1);
      EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), 2.1521110352, std::max(10 * tolerance, 1e-9));
    }
}

}  // namespace
}  // namespace tf::test
