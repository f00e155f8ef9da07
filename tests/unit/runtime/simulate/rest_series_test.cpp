// Points of rest extrapolated from estimates with known errors.
#include "runtime/simulate/rest_series.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tf::runtime {
namespace {

constexpr double rest = 2;                // the time
constexpr double place = 3, impulse = 5;  // the state's one number beside tau, and what comes together in all
constexpr double scale[] = {1, 1};

// With errors of `order` and the next ones, as far as `remaining` from the point.
RestEstimate estimateAt(double remaining, int order) {
  const auto error = [=](double a, double b) { return a * std::pow(remaining, order) + b * std::pow(remaining, order + 1); };
  RestEstimate estimate;
  estimate.remaining = remaining;
  estimate.point.time = rest + error(0.3, -0.2);
  estimate.point.state = {place + error(0.5, 0.1), 0};
  estimate.point.contacts = {0};
  estimate.point.accumulated = {impulse * remaining + error(0.2, 0.4)};
  estimate.totals = {impulse + error(0.2, 0.4)};
  // By a parameter that moves all of this by as much as the point: place, time and T.
  estimate.derivatives = {1 + error(0.5, 0.1), 0.5 + error(0.3, -0.2), 0};
  return estimate;
}

TEST(RestSeries, ExtrapolatesErrorsOfOrderTwo) {
  RestSeries series(2, 1);
  double remaining = 0.1;
  EXPECT_TRUE(series.isEmpty());
  for (int k = 0; k < 3; ++k, remaining *= 0.5) {
    EXPECT_TRUE(series.isWanted(remaining));
    EXPECT_FALSE(series.add(estimateAt(remaining, 2)));
    EXPECT_FALSE(series.extrapolate(1e-12, scale, 1)) << k;
  }
  series.add(estimateAt(remaining, 2));
  ASSERT_TRUE(series.extrapolate(1e-12, scale, 1));
  EXPECT_NEAR(series.point().time, rest, 1e-13);
  EXPECT_NEAR(series.point().state[0], place, 1e-13);
  EXPECT_NEAR(series.point().accumulated[0], impulse * remaining, 1e-12);
  ASSERT_TRUE(series.derivativesAgree(1e-9, 1));
  EXPECT_NEAR(series.point().derivatives[0], 1, 1e-9);
  EXPECT_NEAR(series.point().derivatives[1], 0.5, 1e-9);
}

// Switches that change between estimates make errors of order one, which the powers from two on would not remove.
TEST(RestSeries, ExtrapolatesErrorsOfOrderOneWhereSwitchesAlternate) {
  for (const bool isKnown : {true, false}) {
    RestSeries series(2, 1);
    double remaining = 0.1;
    bool agrees = false;
    for (int k = 0; k < 6; ++k, remaining *= 0.5) {
      if (isKnown)
        series.recordSwitch(0);
      series.add(estimateAt(remaining, 1));
      EXPECT_EQ(series.alternates(0), isKnown);
      agrees = series.extrapolate(1e-10, scale, 1);
    }
    EXPECT_EQ(agrees, isKnown);
    EXPECT_NEAR(series.point().time, isKnown ? rest : 0, 1e-12);
  }
}

TEST(RestSeries, BeginsAnewWithAnotherPoint) {
  RestSeries series(2, 0);
  series.add(estimateAt(0.1, 2));
  EXPECT_FALSE(series.isWanted(0.09));
  RestEstimate other = estimateAt(0.05, 2);
  other.point.contacts = {0, 1};
  EXPECT_TRUE(series.add(other));
  EXPECT_EQ(series.last().point.contacts, (std::vector<int>{0, 1}));
  // The same one again, but no nearer.
  EXPECT_TRUE(series.isWanted(0.06));
  other.remaining = 0.06;
  EXPECT_TRUE(series.add(other));
  EXPECT_FALSE(series.extrapolate(1, scale, 1));
}

}  // namespace
}  // namespace tf::runtime
