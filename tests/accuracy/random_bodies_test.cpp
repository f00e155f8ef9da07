// Boxes of random size, friction and motion against the reference solver that tries all modes: impacts with reversal and stick, rocking,
// tipping, redundant rest.
#include "tests/accuracy/support/compiled_model.h"
#include "tests/accuracy/support/planar_reference.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace tf::test {
namespace {

struct RandomBox {
  double a, b, mu, phi, vx, vy, w;
};

std::vector<RandomBox> randomBoxes(int count) {
  std::mt19937_64 generator(20230911);
  // std::uniform_real_distribution differs between libraries.
  const auto between = [&](double low, double high) { return low + (high - low) * static_cast<double>(generator() >> 11) * 0x1p-53; };
  std::vector<RandomBox> boxes;
  for (int i = 0; i < count; ++i) {
    boxes.push_back({between(0.3, 1), between(0.3, 1), between(0, 0.8), between(0, 3), between(-3, 3), between(-2, 2), between(-6, 6)});
  }
  return boxes;
}

const std::vector<double> &sampleTimes() {
  static const std::vector<double> times = [] {
    std::vector<double> grid;
    for (int i = 1; i <= 80; ++i) {
      grid.push_back(0.025 * i + 1e-4);
    }
    return grid;
  }();
  return times;
}

FloorSolution referenceOf(const RandomBox &box) {
  const Number a = box.a, b = box.b;
  const FloorBody body{.mass = 1,
                       .inertia = (a * a + b * b) / 12,
                       .mu = box.mu,
                       .g = Number(9.81),
                       .corners = {{-a / 2, -b / 2}, {a / 2, -b / 2}, {a / 2, b / 2}, {-a / 2, b / 2}},
                       .start = {0, 1, box.phi, box.vx, box.vy, box.w}};
  return solve(body, sampleTimes());
}

class RandomBoxes : public testing::TestWithParam<tf_integrator> {};

TEST_P(RandomBoxes, FollowTheReference) {
  const std::vector<double> &grid = sampleTimes();
  constexpr std::array kVariables = {"r[1]", "r[2]", "phi", "der(r[1])", "der(r[2])", "der(phi)"};
  CompiledModel model(example("falling_box.tf"));
  model.tolerance(1e-10).integrator(GetParam());
  int number = 0, whole = 0, reversals = 0, sticks = 0;
  for (const RandomBox &box : randomBoxes(40)) {
    const FloorSolution exact = referenceOf(box);
    whole += exact.validUntil >= grid.back();
    reversals += exact.reversals;
    sticks += exact.sticks;
    const std::array<std::pair<const char *, double>, 7> settings = {
        {{"a", box.a}, {"b", box.b}, {"mu", box.mu}, {"phi", box.phi}, {"der(r[1])", box.vx}, {"der(r[2])", box.vy}, {"der(phi)", box.w}}};
    for (const auto &[name, value] : settings) {
      ASSERT_EQ(tf_set(model.simulation(), name, value), TF_OK) << tf_error_text(model.simulation());
    }
    model.initialise();
    for (std::size_t i = 0; i < grid.size() && grid[i] < exact.validUntil; ++i) {
      model.advance(grid[i]);
      for (std::size_t k = 0; k < kVariables.size(); ++k) {
        ASSERT_NEAR(model[kVariables[k]], static_cast<double>(exact.samples[i][k]), 1e-6)
            << kVariables[k] << " of box " << number << " at t = " << grid[i];
      }
    }
    ++number;
  }
  // The cases are worth their time.
  EXPECT_GE(whole, 20);
  EXPECT_GE(reversals, 20);
  EXPECT_GE(sticks, 20);
}

INSTANTIATE_TEST_SUITE_P(Integrators, RandomBoxes, testing::Values(TF_AUTO, TF_STEP, TF_EXPLICIT));

}  // namespace
}  // namespace tf::test
