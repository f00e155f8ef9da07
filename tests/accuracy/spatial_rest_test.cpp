// Bounces with friction in two directions that accumulate into rest (theory.md section 3, Zeno, with section 4).
#include "tests/accuracy/support/compiled_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

constexpr double gravity = 9.81, slope = 0.4, frictionCoefficient = 0.15, restitution = 0.6;

// A particle that bounces on a slope, from bounce to bounce: flights are parabolas; an impact takes μ times the normal impulse off the
// slip, along the slip.
struct Bounces {
  std::array<double, 2> slip = {3, 1};
  std::array<double, 2> place = {0, 0};
  double time = 0;

  Bounces() {
    const double normal = gravity * std::cos(slope), along = gravity * std::sin(slope);
    double speed = std::sqrt(2 * normal), flight = speed / normal;
    while (flight > 1e-17) {
      place[0] += slip[0] * flight;
      place[1] += slip[1] * flight - 0.5 * along * flight * flight;
      slip[1] -= along * flight;
      time += flight;
      const double size = std::hypot(slip[0], slip[1]), loss = std::min(size, frictionCoefficient * (1 + restitution) * speed);
      for (double &component : slip)
        component *= 1 - loss / size;
      speed *= restitution;
      flight = 2 * speed / normal;
    }
  }
};

class SpatialRest : public testing::TestWithParam<double> {};

TEST_P(SpatialRest, ParticleOnASlope) {
  const double tolerance = GetParam();
  CompiledModel model(sourceFile("bouncing_particle", R"(
model BouncingParticle
  parameter Real a = 0.4;
  coordinate Real x(der(start = 3)), y(der(start = 1)), z(start = 1);
  body particle(mass = 2, position = {x, y, z});
  gravity weight(acceleration = 9.81*{0, -sin(a), -cos(a)});
  contact floor(gap = z, slip = {der(x), der(y)}, friction = 0.15, restitution = 0.6);
end BouncingParticle;
)"));
  model.tolerance(tolerance).initialise();
  const Bounces bounces;
  model.advance(bounces.time + 20 * tolerance);
  EXPECT_NEAR(model.eventTime(TF_EVENT_REST), bounces.time, 10 * tolerance);
  EXPECT_EQ(model["floor.closed"], 1);
  const double later = 20 * tolerance;
  EXPECT_NEAR(model["x"], bounces.place[0] + later * bounces.slip[0], 10 * tolerance);
  EXPECT_NEAR(model["y"], bounces.place[1] + later * bounces.slip[1], 10 * tolerance);
  EXPECT_NEAR(model["z"], 0, 1e-12);
  const double deceleration = frictionCoefficient * gravity * std::cos(slope) / std::hypot(bounces.slip[0], bounces.slip[1]);
  EXPECT_NEAR(model["der(x)"], bounces.slip[0] * (1 - later * deceleration), 10 * tolerance);
  EXPECT_NEAR(model["der(y)"], bounces.slip[1] * (1 - later * deceleration) - later * gravity * std::sin(slope), 10 * tolerance);
  // Far fewer impacts than it takes to come down to rounding.
  EXPECT_LT(model.count(TF_EVENT_IMPACT), 40);
}

INSTANTIATE_TEST_SUITE_P(Tolerances, SpatialRest, testing::Values(1e-5, 1e-7, 1e-9));

// Four balls between walls, with pairs that touch, bounces that accumulate while others slide, and everything at rest in the end.
TEST(SpatialRest, BallsBetweenWalls) {
  CompiledModel model(sourceFile("balls_between_walls", R"(
model BallsBetweenWalls
  constant Integer n = 4, m = 6;
  constant Integer a[m] = {1, 1, 1, 2, 2, 3}, b[m] = {2, 3, 4, 3, 4, 4};
  parameter Real R = 0.1, w = 0.25, mu = 0.4, e = 0.3;
  coordinate Real c[n, 3](start = {{0.03*(-1)^k, 0.02*(-1)^div(k, 2), 0.12 + 0.22*k} for k in 1:n});
  coordinate Rotation Q[n];
  Real omega[n, 3] = {Q[k]*Q[k].w for k in 1:n};
  body ball[n](each mass = 1, position = c, orientation = Q, each inertia = 0.4*R^2*identity(3));
  gravity weight(acceleration = {0, 0, -9.81});
  contact floor[n](gap = c[:, 3] - fill(R, n), each friction = mu, each restitution = e,
    slip = {{der(c[k, 1]) - R*omega[k, 2], der(c[k, 2]) + R*omega[k, 1]} for k in 1:n});
  contact right[n](gap = fill(w - R, n) - c[:, 1], each friction = mu, each restitution = e,
    slip = {{der(c[k, 2]) + R*omega[k, 3], der(c[k, 3]) - R*omega[k, 2]} for k in 1:n});
  contact left[n](gap = fill(w - R, n) + c[:, 1], each friction = mu, each restitution = e,
    slip = {{der(c[k, 2]) - R*omega[k, 3], der(c[k, 3]) + R*omega[k, 2]} for k in 1:n});
  contact back[n](gap = fill(w - R, n) - c[:, 2], each friction = mu, each restitution = e,
    slip = {{der(c[k, 1]) - R*omega[k, 3], der(c[k, 3]) + R*omega[k, 1]} for k in 1:n});
  contact front[n](gap = fill(w - R, n) + c[:, 2], each friction = mu, each restitution = e,
    slip = {{der(c[k, 1]) + R*omega[k, 3], der(c[k, 3]) - R*omega[k, 1]} for k in 1:n});
  Real d[m, 3] = {c[b[k], :] - c[a[k], :] for k in 1:m};
  contact pair[m](gap = {sqrt(d[k, :]*d[k, :]) - 2*R for k in 1:m}, each restitution = e);
end BallsBetweenWalls;
)"));
  tf_set_energy_balance(model.simulation(), 1);
  model.tolerance(1e-7).initialise();
  double energy = model.energy();
  for (int k = 1; k <= 30; ++k) {
    model.advance(0.1 * k);
    EXPECT_LE(model.energy(), energy + 1e-7) << model.time();
    energy = model.energy();
  }
  const tf_statistics &statistics = *tf_get_statistics(model.simulation());
  EXPECT_GT(statistics.worst_gap, -1e-9);
  EXPECT_LT(statistics.worst_energy_error, 1e-7);
  EXPECT_GT(statistics.events[TF_EVENT_REST], 3);
}

}  // namespace
}  // namespace tf::test
