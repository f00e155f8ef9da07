// ROCK2's coefficients: order, stability and the error estimate; the method on a mode.
#include "runtime/integrate/rock2.h"

#include "runtime/model/model_instance.h"
#include "tests/unit/runtime/hand_written_models.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>

namespace tf::runtime {
namespace {

// One step of y' = f(t, y) for anything that can be added; the error estimate with it.
template <class State, class Rate> State takeStep(const Rock2Tableau &t, double begin, State y, double h, const Rate &f, State *error) {
  State before = y, last = y, input = f(begin, y);
  for (std::size_t j = 0; j < t.mu.size(); ++j) {
    if (j > 0)
      input = f(begin + h * t.node[j - 1], last);
    const State next = last + t.kappa[j] * (last - before) + h * t.mu[j] * input;
    before = last;
    last = next;
  }
  const State first = f(begin + h * t.lastNode[0], last);
  const State second = f(begin + h * t.lastNode[1], last + h * t.weight * first);
  if (error != nullptr)
    *error = h * (t.error[0] * input + t.error[1] * first + t.error[2] * second);
  return last + h * (t.result[0] * first + t.result[1] * second);
}

// The stability polynomial.
double amplification(const Rock2Tableau &t, double x, double *error = nullptr) {
  return takeStep(t, 0.0, 1.0, 1.0, [x](double, double y) { return x * y; }, error);
}

// z' = i cos(t) z², whose solution is 1/(1 − i sin t): nonlinear and with time. The sum of the estimates' sizes into `estimated`.
double convergenceError(const Rock2Tableau &t, int steps, double *estimated) {
  using Complex = std::complex<double>;
  const Complex i{0, 1};
  const double h = 1.0 / steps;
  Complex z = 1;
  *estimated = 0;
  for (int k = 0; k < steps; ++k) {
    Complex error;
    z = takeStep(t, k * h, z, h, [&](double time, Complex y) { return i * std::cos(time) * y * y; }, &error);
    *estimated += std::abs(error);
  }
  return std::abs(z - 1.0 / (1.0 - i * std::sin(1.0)));
}

TEST(Rock2Tableaus, HaveOrderTwoAndEstimateTheErrorOfThatOrder) {
  for (const Rock2Tableau &t : rock2Tableaus()) {
    SCOPED_TRACE(std::to_string(t.stages) + " stages");
    double wide = 0, narrow = 0;
    const double error = convergenceError(t, 32, &wide), smaller = convergenceError(t, 64, &narrow);
    EXPECT_NEAR(std::log2(error / smaller), 2, 0.15);
    EXPECT_NEAR(std::log2(wide / narrow), 2, 0.15);
    EXPECT_GE(narrow, 0.3 * smaller);
    EXPECT_LE(narrow, 10 * smaller);
  }
}

TEST(Rock2Tableaus, AreStableOnALongRealInterval) {
  for (const Rock2Tableau &t : rock2Tableaus()) {
    SCOPED_TRACE(std::to_string(t.stages) + " stages");
    EXPECT_GE(t.border, 0.68 * t.stages * t.stages);
    double worst = 0;
    for (int k = 0; k <= 4000; ++k)
      worst = std::max(worst, std::abs(amplification(t, -2.5 - (t.border - 2.5) * k / 4000)));
    EXPECT_LE(worst, 0.96);
    for (double x = -2.5; x <= 0; x += 0.05)
      EXPECT_LE(std::abs(amplification(t, x)), 1 + 1e-12) << x;
  }
}

// Stages in between stay of the size of the state, so that rounding errors do not grow.
TEST(Rock2Tableaus, AreStableInside) {
  for (const Rock2Tableau &t : rock2Tableaus()) {
    double largest = 0;
    for (int k = 0; k <= 400; ++k) {
      const double x = -t.border * k / 400;
      takeStep(
          t, 0.0, 1.0, 1.0, [&](double, double y) { return largest = std::max(largest, std::abs(y)), x * y; },
          static_cast<double *>(nullptr));
    }
    EXPECT_LE(largest, 20) << t.stages << " stages";
  }
}

// The estimate does not miss the error of an eigenvalue, nor does it exceed it by far near zero; far from it it is bounded.
TEST(Rock2Tableaus, EstimateTheirError) {
  for (const Rock2Tableau &t : rock2Tableaus())
    for (const double x : {-0.5, -1.0, -2.0, -4.0, -8.0, -20.0, -50.0}) {
      if (-x > 0.9 * t.border)
        continue;
      double estimate = 0;
      const double error = std::abs(amplification(t, x, &estimate) - std::exp(x));
      EXPECT_GE(std::abs(estimate), 0.3 * error) << t.stages << " stages, " << x;
      EXPECT_LE(std::abs(estimate), x >= -2 ? 4 * error : 13) << t.stages << " stages, " << x;
    }
}

TEST(Rock2Tableaus, AreChosenByTheBorder) {
  EXPECT_EQ(tableauFor(0, rock2Tableaus()).stages, 3);
  EXPECT_EQ(tableauFor(14, rock2Tableaus()).stages, 5);
  EXPECT_EQ(tableauFor(1e9, rock2Tableaus()).stages, rock2Tableaus().back().stages);
}

// The belt's mass in slip: x'' = -4 x + 1 with x(0) = 0, x'(0) = -0.1. One step with so many stages that h times the radius is 100; errors
// of the position and the velocity, at its end and inside.
double beltError(double h) {
  ModelInstance instance(test::beltModel());
  const InputSignals inputs(test::beltModel().nu);
  ModelEvaluation at(test::beltModel(), inputs);
  ModeDynamics dynamics(at);
  const double state[3] = {0, -0.1, 0}, scale[3] = {1, 1, 1};
  double rate[3] = {};
  EXPECT_TRUE(at.setParameters(instance.parameters().data()));
  at.setSegment(0.5);
  EXPECT_TRUE(dynamics.start({{}, {Tangent::SlipNegative}, {}}, 0, state));
  EXPECT_TRUE(dynamics.evaluate(0, state, rate));
  Rock2 method(3);
  method.setRadius(100 / h);
  EXPECT_TRUE(method.solve(dynamics, 0, state, rate, h, scale, 0));
  double error = 0, inside[3];
  for (const double theta : {0.15, 0.4, 0.65, 0.9, 1.0}) {
    const double t = theta * h;
    method.interpolate(theta, inside);
    error = std::max({error, std::abs(inside[0] - (0.25 - 0.25 * std::cos(2 * t) - 0.05 * std::sin(2 * t))),
                      std::abs(inside[1] - (0.5 * std::sin(2 * t) - 0.1 * std::cos(2 * t)))});
  }
  EXPECT_LE(error, 3 * method.errorNorm(scale, 1));
  return error;
}

TEST(Rock2Test, HasTheErrorOfItsOrderAtTheEndAndInside) { EXPECT_NEAR(std::log2(beltError(0.1) / beltError(0.05)), 3, 0.4); }

}  // namespace
}  // namespace tf::runtime
