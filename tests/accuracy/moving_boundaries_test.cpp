// Boundaries whose motion switches with time: gaps, slips and constraints have the side that time goes to, from the start on.
#include "tests/accuracy/compiled_model.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>

namespace tf::test {
namespace {

double worstEnergyError(const CompiledModel &model) { return tf_get_statistics(model.simulation())->worst_energy_error; }

void run(CompiledModel &model, double time) {
  tf_set_energy_balance(model.simulation(), 1);
  model.run(time);
}

TEST(MovingBoundaries, BeltThatStartsAtOnceDragsTheBody) {
  const std::string file = sourceFile("starting_belt.tf", R"(
model StartingBelt
  coordinate Real x;
  body b(mass = 1, position = x);
  friction f(slip = der(x) - (if time < 1 then 0 else 1), bound = 2);
end StartingBelt;
)");
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(file);
    model.tolerance(1e-9).integrator(integrator);
    run(model, 1.2);
    EXPECT_NEAR(model["der(x)"], 0.4, 1e-9);
    model.advance(3);
    EXPECT_NEAR(model["x"], 0.25 + 1.5, 1e-8);
    EXPECT_NEAR(model.eventTime(TF_EVENT_STICK), 1.5, 1e-8);
    EXPECT_LT(worstEnergyError(model), 1e-7);
  }
}

// A jump of the floor's velocity is an impact on the body that rests on it.
TEST(MovingBoundaries, FloorThatStartsAtOnceHitsTheBody) {
  const std::string file = sourceFile("starting_floor.tf", R"(
model StartingFloor
  coordinate Real y;
  body b(mass = 1, position = y);
  force weight(value = -9.81, at = y);
  contact floor(gap = y - (if time <= 1 then 0 else 0.1*(time - 1)), restitution = 0.5);
end StartingFloor;
)");
  for (const tf_integrator integrator : integrators) {
    CompiledModel model(file);
    model.tolerance(1e-9).integrator(integrator);
    run(model, 0.99);
    EXPECT_TRUE(model.events().empty());
    model.advance(1.005);
    EXPECT_NEAR(model["der(y)"], 0.15 - 9.81 * 0.005, 1e-8);
    EXPECT_NEAR(model.eventTime(TF_EVENT_IMPACT), 1, 1e-12);
    EXPECT_LT(worstEnergyError(model), 1e-7);
  }
}

TEST(MovingBoundaries, TheStartHasTheSideOfItsTime) {
  CompiledModel wall(sourceFile("later_wall.tf", R"(
model LaterWall
  coordinate Real x(start = 0.5);
  body b(mass = 1, position = x);
  contact wall(gap = x - (if time < 1 then 0 else (time - 1)^2), restitution = 0);
end LaterWall;
)"));
  wall.tolerance(1e-9);
  run(wall, 3);
  EXPECT_NEAR(wall["x"], 4, 1e-7);
  EXPECT_NEAR(wall.eventTime(TF_EVENT_IMPACT), 1 + std::sqrt(0.5), 1e-9);

  CompiledModel rail(sourceFile("later_rail.tf", R"(
model LaterRail
  coordinate Real x(start = 0.3), y(start = 1);
  body b(mass = 1, position = {x, y});
  constraint rail(residual = y - 1 - (if time < 1 then 0 else 0.5*(time - 1)^2));
end LaterRail;
)"));
  rail.tolerance(1e-9);
  run(rail, 2);
  EXPECT_NEAR(rail["y"], 1.5, 1e-9);
  EXPECT_NEAR(rail["der(y)"], 1, 1e-9);

  CompiledModel spring(sourceFile("switched_spring.tf", R"(
model SwitchedSpring
  coordinate Real x(start = 0.5);
  body b(mass = 1, position = x);
  potential p(energy = if x < 0 then 5*x^2 else 50*x^2);
end SwitchedSpring;
)"));
  spring.tolerance(1e-9);
  run(spring, 2);
  EXPECT_LT(worstEnergyError(spring), 1e-7);
}

std::string errorOf(const std::string &name, const std::string &elements) {
  CompiledModel model(sourceFile(
      name + ".tf", "model " + name + "\n  coordinate Real x(start = 0.3, der(start = 1)), y;\n" + elements +
                        "\n  body b(mass = 1, position = {x, y});\n  gravity w(acceleration = {0, -9.81});\nend " + name + ";\n"));
  model.tolerance(1e-8);
  try {
    run(model, 2);
  } catch (const std::runtime_error &error) {
    return error.what();
  }
  return "";
}

// What no impact can follow is an error, not a wrong motion.
TEST(MovingBoundaries, JumpsThatNothingFollowsAreErrors) {
  const auto expect = [](const std::string &text, const std::string &part) { EXPECT_NE(text.find(part), std::string::npos) << text; };
  expect(errorOf("JumpingFloor", "  contact floor(gap = y - (if time < 1 then 0 else 0.2));"),
         "the gap of contact 'floor' jumps to -0.2 (");
  expect(errorOf("JumpingRail", "  constraint rail(residual = y - (if time < 1 then 0 else 0.2));"),
         "the residual of constraint 'rail' jumps to -0.2 (");
  expect(errorOf("StartingRail", "  constraint rail(residual = y - (if time < 1 then 0 else 0.2*(time - 1)));"),
         "the velocity of constraint 'rail' jumps by 0.2, which only contacts may (");
  expect(errorOf("Negative", "  contact floor(gap = y, slip = der(x), friction = if x < 0.5 then 0.01 else -1);"),
         "the friction coefficient of contact 'floor' is -1, it cannot be negative (");
}

// The gap opens with the third power of time, more slowly than a long step at a loose tolerance is wrong.
TEST(MovingBoundaries, AWheelLeavesTheRoadOnce) {
  const std::string file = sourceFile("quarter_car.tf", R"(
model QuarterCar
  parameter Real M = 75, m = 20, k = 20000, A = 0.1, w = 15, g = 9.81;
  Real road = A*sin(w*time)*(if time < 0.1 then 0 else 1 - exp(-5*(time - 0.1)));
  coordinate Real zb(start = -M*g/k), zw;
  body chassis(mass = M, position = {0, zb});
  body wheel(mass = m, position = {0, zw});
  gravity weight(acceleration = {0, -g});
  potential spring(energy = k/2*(zb - zw)^2);
  contact ground(gap = zw - road);
end QuarterCar;
)");
  const auto run = [&](tf_integrator integrator, double tolerance, double amplitude) {
    CompiledModel model(file, {{"A", amplitude}});
    model.tolerance(tolerance).integrator(integrator).run(0.5);
    EXPECT_GE(model.count(TF_EVENT_OPENING), 1);
    EXPECT_LE(model.count(TF_EVENT_OPENING), 2);
    return model["zb"];
  };
  for (const double amplitude : {0.1, 0.15}) {
    const double exact = run(TF_STEP, 1e-11, amplitude);
    for (const tf_integrator integrator : integrators)
      for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-6})
        EXPECT_NEAR(run(integrator, tolerance, amplitude), exact, 10 * tolerance) << tolerance;
  }
}

}  // namespace
}  // namespace tf::test
