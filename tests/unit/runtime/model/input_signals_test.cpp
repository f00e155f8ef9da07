#include "runtime/model/input_signals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct ValueAndRate {
  double value, rate;
};

ValueAndRate at(const InputSignals &signals, double time, double segment) {
  double u[1], rate[1];
  signals.evaluate(time, segment, u, rate);
  return {u[0], rate[0]};
}

InputSignals table(std::vector<double> times, std::vector<double> values, Interpolation interpolation) {
  InputSignals signals(1);
  const auto set = signals.setTable(0, times, values, interpolation);
  EXPECT_TRUE(set.ok()) << set.error();
  return signals;
}

TEST(InputSignals, HoldDefaultsUntilTheyAreGiven) {
  InputSignals signals(2);
  const double defaults[] = {3, 4};
  signals.setConstant(1, 7);
  signals.setDefaults(defaults);
  double u[2];
  signals.evaluate(0, 1, u, nullptr);
  EXPECT_EQ(u[0], 3);
  EXPECT_EQ(u[1], 7);
  EXPECT_FALSE(signals.isGiven(0));
  EXPECT_TRUE(signals.isGiven(1));
  EXPECT_TRUE(signals.isConstant(0));
  EXPECT_EQ(signals.nextBreakpoint(0), infinity);
}

TEST(InputSignals, ZeroOrderHoldTakesTheSegmentsSideAtBreakpoints) {
  const InputSignals signals = table({0, 0.5, 1}, {1, -1, 0}, Interpolation::ZeroOrderHold);
  EXPECT_EQ(at(signals, -1, -1).value, 1);
  EXPECT_EQ(at(signals, 0.25, 0.25).value, 1);
  EXPECT_EQ(at(signals, 0.5, 0.4).value, 1);
  EXPECT_EQ(at(signals, 0.5, 0.6).value, -1);
  EXPECT_EQ(at(signals, 0.5, 0.5).value, -1);
  EXPECT_EQ(at(signals, 9, 9).value, 0);
  EXPECT_EQ(at(signals, 0.1, 0.2).value, 1);   // back again
  EXPECT_EQ(signals.nextBreakpoint(-2), 0.5);  // nothing changes at 0
  EXPECT_EQ(signals.nextBreakpoint(0.5), 1);
  EXPECT_EQ(signals.nextBreakpoint(1), infinity);
  EXPECT_TRUE(signals.isConstant(0.7));
}

TEST(InputSignals, LinearTablesAreExactAndHeldOutside) {
  const InputSignals signals = table({1, 2, 4}, {10, 20, 0}, Interpolation::Linear);
  EXPECT_EQ(at(signals, 0, 0).value, 10);
  EXPECT_EQ(at(signals, 0, 0).rate, 0);
  EXPECT_EQ(at(signals, 1.25, 1.25).value, 12.5);
  EXPECT_EQ(at(signals, 1.25, 1.25).rate, 10);
  EXPECT_EQ(at(signals, 2, 1.9).value, 20);
  EXPECT_EQ(at(signals, 2, 1.9).rate, 10);
  EXPECT_EQ(at(signals, 2, 2.1).rate, -10);
  EXPECT_EQ(at(signals, 2.5, 1.5).value, 25);  // the piece's continuation
  EXPECT_EQ(at(signals, 5, 5).value, 0);
  EXPECT_EQ(at(signals, 5, 5).rate, 0);
  EXPECT_EQ(signals.nextBreakpoint(0), 1);
  EXPECT_EQ(signals.nextBreakpoint(1), 2);
  EXPECT_EQ(signals.nextBreakpoint(2), 4);
  EXPECT_EQ(signals.nextBreakpoint(4), infinity);
  EXPECT_FALSE(signals.isConstant(3));
  EXPECT_TRUE(signals.isConstant(5));
}

TEST(InputSignals, EqualTimesAreJumps) {
  const InputSignals signals = table({0, 1, 1, 1, 2}, {0, 1, 77, 5, 5}, Interpolation::Linear);
  EXPECT_EQ(at(signals, 1, 0.5).value, 1);
  EXPECT_EQ(at(signals, 1, 1.5).value, 5);
  EXPECT_EQ(at(signals, 1, 1.5).rate, 0);
  EXPECT_EQ(signals.nextBreakpoint(0), 1);
  EXPECT_EQ(signals.nextBreakpoint(1), infinity);  // 5 is held
  const InputSignals held = table({0, 1, 1}, {0, 3, 4}, Interpolation::ZeroOrderHold);
  EXPECT_EQ(at(held, 1, 0.9).value, 0);
  EXPECT_EQ(at(held, 1, 1.1).value, 4);
}

TEST(InputSignals, OnePointIsAConstant) {
  const InputSignals signals = table({3}, {2}, Interpolation::Linear);
  EXPECT_EQ(at(signals, 0, 0).value, 2);
  EXPECT_EQ(at(signals, 4, 4).value, 2);
  EXPECT_EQ(signals.nextBreakpoint(0), infinity);
}

TEST(InputSignals, LookUpsInAnyOrderFindTheSamePiece) {
  std::vector<double> times, values;
  for (int i = 0; i <= 1000; ++i) {
    times.push_back(i);
    values.push_back(i * i);
  }
  const InputSignals signals = table(times, values, Interpolation::ZeroOrderHold);
  for (int i = 0; i < 2000; ++i) {
    const int k = (i * 7919) % 1000;
    EXPECT_EQ(at(signals, k + 0.5, k + 0.5).value, k * k);
  }
}

TEST(InputSignals, RefuseBadTables) {
  InputSignals signals(1);
  const auto error = [&](std::vector<double> times, std::vector<double> values) {
    const auto set = signals.setTable(0, times, values, Interpolation::Linear);
    return set.ok() ? "" : set.error();
  };
  EXPECT_EQ(error({}, {}), "an input table needs at least one point, and as many values as times");
  EXPECT_EQ(error({0, 1}, {0}), "an input table needs at least one point, and as many values as times");
  EXPECT_EQ(error({0, 1, 0.5}, {0, 0, 0}), "the times of an input table must not decrease: point 3 is at 0.5, after 1");
  EXPECT_EQ(error({0, 1}, {0, infinity}), "point 2 of the input table is not finite");
  EXPECT_FALSE(signals.isGiven(0));
}

TEST(InputSignals, FunctionsHaveRatesByDifferences) {
  InputSignals signals(1);
  signals.setFunction(0, {[](double time, double) { return std::sin(20 * time); }, {}, {}});
  for (const double time : {0.0, 0.3, 100.7}) {
    EXPECT_EQ(at(signals, time, time + 0.1).value, std::sin(20 * time));
    EXPECT_NEAR(at(signals, time, time + 0.1).rate, 20 * std::cos(20 * time), 3e-9);
  }
  EXPECT_FALSE(signals.isConstant(0));
  signals.setFunction(0, {[](double, double) { return 1.0; }, [](double, double) { return 42.0; }, {}});
  EXPECT_EQ(at(signals, 0, 1).rate, 42);
}

TEST(InputSignals, RatesAreTakenFromTheSegmentsSideWhereAFunctionEnds) {
  InputSignals signals(1);
  signals.setFunction(0, {[](double time, double) { return std::pow(time, 1.5); }, {}, {}});  // NaN before 0
  EXPECT_NEAR(at(signals, 0, 1).rate, 0, 0.05);
  signals.setFunction(0, {[](double time, double) { return time < 0 ? std::nan("") : 3 * time; }, {}, {}});
  EXPECT_NEAR(at(signals, 0, 1).rate, 3, 1e-9);
}

TEST(InputSignals, FunctionsGetTheSegmentAndGiveBreakpoints) {
  InputSignals signals(1);
  signals.setFunction(0, {[](double time, double segment) { return segment < 1 ? 0.0 : 2 * (time - 1); },
                          {},
                          [](double time) { return time < 1 ? 1.0 : infinity; }});
  EXPECT_EQ(at(signals, 1, 0.5).rate, 0);
  EXPECT_NEAR(at(signals, 1, 1.5).rate, 2, 1e-10);
  EXPECT_EQ(signals.nextBreakpoint(0), 1);
  EXPECT_EQ(signals.nextBreakpoint(1), infinity);
}

TEST(InputSignals, TheLastSettingCounts) {
  InputSignals signals = table({0, 1}, {1, 2}, Interpolation::Linear);
  const auto revision = signals.revision();
  signals.setConstant(0, 9);
  EXPECT_GT(signals.revision(), revision);
  EXPECT_EQ(at(signals, 0.5, 0.5).value, 9);
  EXPECT_EQ(signals.nextBreakpoint(0), infinity);
}

}  // namespace

}  // namespace tf::runtime
