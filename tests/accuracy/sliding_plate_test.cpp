// A plate on feet with Coulomb friction slides and spins, and both end at one time (Goyal, Ruina, Papadopoulos, Wear 143, 1991), against an
// integration of its own that takes steps in proportion to the speed that is left.
#include "tests/accuracy/each_integrator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <ostream>

namespace tf::test {
namespace {

using State = std::array<double, 6>;  // x, y, psi and their rates

struct Plate {
  double inertia, bound;
  std::vector<std::array<double, 2>> feet;

  // Sets `slowest` to the least speed of a foot.
  State rate(const State &y, double &slowest) const {
    State dy = {y[3], y[4], y[5], 0, 0, 0};
    slowest = std::numeric_limits<double>::infinity();
    for (const auto &[a, b] : feet) {
      const double rx = std::cos(y[2]) * a - std::sin(y[2]) * b, ry = std::sin(y[2]) * a + std::cos(y[2]) * b;
      const double vx = y[3] - ry * y[5], vy = y[4] + rx * y[5], speed = std::hypot(vx, vy);
      slowest = std::min(slowest, speed);
      const double fx = -bound * vx / speed, fy = -bound * vy / speed;
      dy[3] += fx;
      dy[4] += fy;
      dy[5] += (rx * fy - ry * fx) / inertia;
    }
    return dy;
  }
};

State moved(const State &y, const State &rate, double h) {
  State result;
  for (std::size_t i = 0; i < y.size(); ++i)
    result[i] = y[i] + h * rate[i];
  return result;
}

// Where the plate stands, and when: Runge and Kutta's method with steps of a hundredth of the time in which the slowest foot would stop.
std::pair<State, double> rest(const Plate &plate, State y) {
  double time = 0, slowest = 0, ignored = 0;
  while (std::abs(y[3]) + std::abs(y[4]) + std::abs(y[5]) > 1e-13) {
    const State k1 = plate.rate(y, slowest);
    const double h = 1e-2 * slowest / std::hypot(k1[3], k1[4], k1[5]);
    const State k2 = plate.rate(moved(y, k1, h / 2), ignored), k3 = plate.rate(moved(y, k2, h / 2), ignored),
                k4 = plate.rate(moved(y, k3, h), ignored);
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    time += h;
  }
  return {y, time};
}

// Eight feet on a ring; rates of x, y, psi at the start.
struct PlateCase {
  double tolerance;
  std::array<double, 3> rates;
};

void PrintTo(const PlateCase &one, std::ostream *stream) { *stream << one.tolerance; }

class SlidingPlate : public testing::TestWithParam<PlateCase> {};

TEST_P(SlidingPlate, StopsAsAWhole) {
  const std::string file = sourceFile("sliding_plate", R"(
model SlidingPlate
  parameter Real feet[8, 2] = {0.5*{cos(k*0.7853981633974483), sin(k*0.7853981633974483)} for k in 1:8};
  coordinate Real x, y, psi;
  Real foot[8, 2] = {{x + cos(psi)*feet[k, 1] - sin(psi)*feet[k, 2], y + sin(psi)*feet[k, 1] + cos(psi)*feet[k, 2]} for k in 1:8};
  body plate(mass = 1, position = {x, y}, angle = psi, inertia = 0.1);
  friction foot_floor[8](slip = der(foot), each bound = 0.3);
end SlidingPlate;
)");
  const auto [tolerance, rates] = GetParam();
  Plate plate = {0.1, 0.3, {}};
  for (int k = 1; k <= 8; ++k)
    plate.feet.push_back({0.5 * std::cos(k * 0.7853981633974483), 0.5 * std::sin(k * 0.7853981633974483)});
  const auto [state, time] = rest(plate, {0, 0, 0, rates[0], rates[1], rates[2]});
  CompiledModel model(file, {{"der(x)", rates[0]}, {"der(y)", rates[1]}, {"der(psi)", rates[2]}});
  model.tolerance(tolerance).run(1);
  EXPECT_NEAR(model["x"], state[0], tolerance);
  EXPECT_NEAR(model["y"], state[1], tolerance);
  EXPECT_NEAR(model["psi"], state[2], tolerance);
  EXPECT_LT(std::abs(model["der(x)"]) + std::abs(model["der(y)"]) + std::abs(model["der(psi)"]), 1e-15);
  ASSERT_FALSE(model.events().empty());
  EXPECT_EQ(model.events().back().kind, TF_EVENT_STICK);
  EXPECT_NEAR(model.events().back().time, time, 10 * tolerance);
}

std::vector<PlateCase> plateCases() {
  std::vector<PlateCase> all;
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10})
    for (const std::array<double, 3> &rates : {std::array{1.0, 0.2, 1.5}, std::array{0.3, 0.1, 4.0}, std::array{1.0, 0.2, 0.5}})
      all.push_back({tolerance, rates});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Tolerances, SlidingPlate, testing::ValuesIn(plateCases()));

// A pull that turns and is larger than friction for an instant only: the slip is about as slow as errors are.
TEST(BriefSlip, EndsWithAnyTolerance) {
  const std::string file = sourceFile("brief_slip.tf", R"(
model BriefSlip
  parameter Real c = 2.4;
  coordinate Real p[3];
  body b(mass = 1, position = p);
  force f(value = {2.899, c*sin(time), -9.372}, at = p);
  contact k(gap = p[3], slip = der(p[1:2]), friction = 0.4);
end BriefSlip;
)");
  for (const double c : {2.395, 2.4, 2.405, 2.41}) {
    SCOPED_TRACE(c);
    CompiledModel reference(file, {{"c", c}});
    reference.tolerance(1e-11).run(3);
    for (const double tolerance : {1e-6, 1e-7, 1e-8, 1e-9})
      withEachIntegrator(file, tolerance, 3,
                         [&](const CompiledModel &model) {
                           EXPECT_EQ(model.count(TF_EVENT_STICK), 1);
                           EXPECT_NEAR(model["p[1]"], reference["p[1]"], 10 * tolerance);
                           EXPECT_NEAR(model["p[2]"], reference["p[2]"], 10 * tolerance);
                         },
                         {{"c", c}});
  }
}

// A mass on a circle, against friction in the plane: its slip turns all the way to the stop at t = 2, and is never anywhere else than along
// the circle.
TEST(SlipsThatTurn, StopOnACurveWhereTheyDo) {
  const std::string file = sourceFile("stop_on_a_circle.tf", R"(
model Circle
  coordinate Real ph(start = 0, der(start = 2));
  Real p[2] = {cos(ph), sin(ph)};
  body b(mass = 1, position = p);
  friction c(slip = der(p), bound = 1);
end Circle;
)");
  for (const tf_integrator integrator : integrators)
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10})
      for (const double interval : {0.01, 0.3, 3.0}) {
        SCOPED_TRACE("integrator " + std::to_string(integrator) + ", " + std::to_string(tolerance) + ", " + std::to_string(interval));
        CompiledModel model(file);
        model.tolerance(tolerance).integrator(integrator).initialise();
        for (int k = 1; k * interval < 3 + 0.5 * interval; ++k)
          model.advance(k * interval);
        EXPECT_NEAR(model["ph"], 2, 10 * tolerance);
        EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), 2, 100 * tolerance);
        EXPECT_NEAR(model["der(ph)"], 0, 1e-15);
      }
}

}  // namespace
}  // namespace tf::test
