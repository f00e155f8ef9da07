// Order of the Step integrator across switches: fixed-step runs of a stick-slip oscillator without closed form (examples/duffing.tf). Radau
// IIA with s stages has order 2s - 1 in the state and, because a switch is solved for together with the state, in the switch times too.
#include "tests/accuracy/support/compiled_model.h"
#include "tests/accuracy/support/dry_friction_reference.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

constexpr double kEnd = 6.5;

const FrictionSolution &reference() {
  static const FrictionSolution solution = [] {
    const Number speed = 0.6, part = 0.7;  // doubles, as the model's parameters are
    DryFriction problem{.mass = 1, .bound = 1, .force = [](Number, Number x, Number) { return -x - x * x * x; }};
    problem.belt = [=](Number t) { return speed * (1 + part * std::sin(2 * t)); };
    problem.beltAcceleration = [=](Number t) { return speed * part * 2 * std::cos(2 * t); };
    problem.x = -0.2;
    return solve(problem, {kEnd});
  }();
  return solution;
}

struct Errors {
  double step = 0, state = 0, time = 0;
};

Errors run(CompiledModel &model, int stages, double step) {
  model.integrator(TF_STEP).stepOptions(stages, step).tolerance(1e-12).run(kEnd);
  std::vector<double> times;
  for (const Event &event : model.events()) {
    if (event.kind == TF_EVENT_STICK || event.kind == TF_EVENT_SLIP || event.kind == TF_EVENT_SLIP_REVERSAL) {
      times.push_back(event.time);
    }
  }
  Errors errors{.step = step};
  const FrictionSolution &exact = reference();
  EXPECT_EQ(times.size(), exact.switches.size()) << "step " << step << ", " << stages << " stages";
  for (std::size_t i = 0; i < std::min(times.size(), exact.switches.size()); ++i) {
    errors.time = std::max(errors.time, static_cast<double>(std::abs(times[i] - exact.switches[i].time)));
  }
  errors.state = static_cast<double>(std::max(std::abs(model["x"] - exact.samples[0][0]), std::abs(model["der(x)"] - exact.samples[0][1])));
  return errors;
}

// Slope of log error over log step by least squares, of errors above rounding.
double slope(const std::vector<Errors> &runs, double Errors::*error) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const Errors &r : runs) {
    if (r.*error > 3e-13) {
      const double x = std::log(r.step), y = std::log(r.*error);
      n += 1;
      sx += x;
      sy += y;
      sxx += x * x;
      sxy += x * y;
    }
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

std::vector<double> stepsOf(int stages) {
  const double first[] = {0.02, 0.08, 0.16, 0.24};
  std::vector<double> steps;
  for (int i = 0; i < 9; ++i) {
    steps.push_back(first[stages - 1] * std::pow(2, -0.5 * i));
  }
  return steps;
}

// docs/order.svg is drawn from this table: written where TF_ORDER_TABLE names a folder.
void writeTable(int stages, const std::vector<Errors> &runs) {
  if (const char *folder = std::getenv("TF_ORDER_TABLE")) {
    std::ofstream file(std::string(folder) + "/order" + std::to_string(stages) + ".csv");
    file.precision(17);
    file << "step,state,time\n";
    for (const Errors &r : runs) {
      file << r.step << ',' << r.state << ',' << r.time << '\n';
    }
  }
}

class Order : public testing::TestWithParam<int> {};

TEST_P(Order, IsTwiceTheStagesLessOneAcrossSwitches) {
  const int stages = GetParam();
  CompiledModel model(example("duffing.tf"));
  std::vector<Errors> runs;
  for (const double step : stepsOf(stages)) {
    runs.push_back(run(model, stages, step));
  }
  writeTable(stages, runs);
  ASSERT_GE(reference().switches.size(), 4U);
  EXPECT_NEAR(slope(runs, &Errors::state), 2 * stages - 1, 0.3);
  EXPECT_NEAR(slope(runs, &Errors::time), 2 * stages - 1, 0.3);
}

INSTANTIATE_TEST_SUITE_P(Stages, Order, testing::Values(1, 2, 3, 4));

// The equations of a step across the stop of a slip of two components have no solution.
TEST(FixedSteps, EndWhereASlipOfTwoComponentsStops) {
  const std::string file = sourceFile("puck.tf", R"(
model Puck
  coordinate Real x(der(start = 1)), y(der(start = 0.5));
  body b(mass = 1, position = {x, y});
  force f(value = {0.3, 0.4}, at = {x, y});
  friction fr(slip = {der(x), der(y)}, bound = 2);
end Puck;
)");
  CompiledModel reference(file);
  reference.tolerance(1e-12).integrator(TF_STEP).run(2);
  constexpr double errors[] = {5e-2, 1e-5, 1e-7, 1e-9};
  for (const double step : {0.1, 0.02, 0.003})
    for (int stages = 1; stages <= 4; ++stages) {
      CompiledModel model(file);
      ASSERT_NO_THROW(model.integrator(TF_STEP).stepOptions(stages, step).run(2)) << step << ", " << stages << " stages";
      ASSERT_EQ(model.count(TF_EVENT_STICK), 1);
      EXPECT_NEAR(model["x"], reference["x"], errors[stages - 1]) << step << ", " << stages << " stages";
    }
}

// A hop that one step of one stage is to cover: its end is below the ground however short it is, until gravity has taken all of the speed.
TEST(FixedSteps, OfOneStageComeToRest) {
  CompiledModel model(sourceFile("ball_in_fixed_steps.tf", R"(
model Ball
  coordinate Real y(start = 1);
  body b(mass = 1, position = {0, y});
  gravity g(acceleration = {0, -9.81});
  contact floor(gap = y, restitution = 0.5);
end Ball;
)"));
  for (const double step : {0.1, 0.01, 0.001}) {
    ASSERT_NO_THROW(model.integrator(TF_STEP).stepOptions(1, step).run(3)) << step;
    EXPECT_NEAR(model["y"], 0, 1e-9) << step;
    EXPECT_NEAR(model["der(y)"], 0, 1e-9) << step;
  }
}

}  // namespace
}  // namespace tf::test
