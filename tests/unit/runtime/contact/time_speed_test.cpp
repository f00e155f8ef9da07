#include "runtime/contact/time_speed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace tf::runtime {
namespace {

TEST(TimeSpeed, RunsAtFullSpeedWithoutContacts) { EXPECT_EQ(timeSpeed({}, {}), 1.0); }

TEST(TimeSpeed, OneContactHasTheClosedForm) {
  const std::vector<double> force{9.81}, rate{3.0};
  EXPECT_DOUBLE_EQ(timeSpeed(force, rate), 3.0 / (3.0 + 9.81));
}

TEST(TimeSpeed, TwoContactsSolveTheQuadraticEquation) {
  // β = (1 − pβ)(1 − rβ): p r β² − (1 + p + r) β + 1 = 0, smaller root.
  const double p = 2.5, r = 0.75;
  const std::vector<double> force{2 * p, r}, rate{2.0, 1.0};
  const double b = 1 + p + r;
  EXPECT_NEAR(timeSpeed(force, rate), 2 / (b + std::sqrt(b * b - 4 * p * r)), 1e-15);
}

TEST(TimeSpeed, ManyContactsSatisfyTheEquationToFullPrecision) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-6, 6);
  for (int run = 0; run < 2000; ++run) {
    const std::size_t n = 1 + run % 40;
    std::vector<double> force(n), rate(n);
    double bound = 1;
    for (std::size_t i = 0; i < n; ++i) {
      force[i] = std::pow(10.0, exponent(random));
      rate[i] = std::pow(10.0, exponent(random));
      bound = std::min(bound, rate[i] / force[i]);
    }
    const double beta = timeSpeed(force, rate);
    ASSERT_GT(beta, 0);
    ASSERT_LE(beta, bound);
    long double product = 1, slope = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const long double ratio = static_cast<long double>(force[i]) / rate[i];
      product *= 1 - beta * ratio;
      slope += ratio / (1 - beta * ratio);
    }
    // The error of β by one Newton step.
    const long double error = (product - beta) / (1 + product * slope);
    ASSERT_LT(std::abs(static_cast<double>(error)), 1e-14 * beta) << "run " << run;
  }
}

TEST(TimeSpeed, IgnoresContactsWithoutForce) {
  const std::vector<double> force{0.0, 4.0, -1e-17}, rate{1.0, 2.0, 1.0};
  EXPECT_DOUBLE_EQ(timeSpeed(force, rate), 2.0 / 6.0);
  std::vector<double> push(3);
  pushes(force, rate, timeSpeed(force, rate), push);
  EXPECT_EQ(push[0], 0.0);
  EXPECT_DOUBLE_EQ(push[1], 2.0 / 3.0);
  EXPECT_EQ(push[2], 0.0);
}

TEST(TimeSpeed, StepVariableOfSlip) {
  EXPECT_EQ(slipStepVariable(-2, 2), 1.0);  // v_t > 0
  EXPECT_EQ(slipStepVariable(2, 2), 0.0);
  EXPECT_EQ(slipStepVariable(0.5, 1), 0.25);
  EXPECT_EQ(slipStepVariable(0, 0), 0.5);
}

}  // namespace
}  // namespace tf::runtime
