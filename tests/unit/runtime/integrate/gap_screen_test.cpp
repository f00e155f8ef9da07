#include "runtime/integrate/gap_screen.h"

#include "runtime/integrate/model_evaluation.h"
#include "runtime/model/input_signals.h"
#include "tests/unit/runtime/model_tables.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace {

using namespace tf::runtime;
using namespace tf::runtime::test;

// A particle on a line and walls at 1, 2, … 16; where the last coordinate is the time, the walls come nearer at speed 1.
template <int timeFactor> struct Walls {
  static constexpr int count = 16;
  ModelTables tables{"Walls", ""};
  std::vector<std::int32_t> variation = std::vector<std::int32_t>(count + 1, timeFactor != 0 ? TF_VARIES_WITH_TIME : 0);

  Walls() {
    tables.coordinates({"x"}, "m");
    for (int i = 0; i < count; ++i)
      tables.contact("wall" + std::to_string(i), 0);
    tables.finish();
    tables.model().variation = variation.data();
    tables.model().gap_bounds = [](In in, Out out, Mask) {
      for (int i = 0; i < count; ++i) {
        out[0][i] = i + 1 - in[TF_IN_Q][0] - timeFactor * in[TF_IN_TIME][0];
        out[1][i] = in[TF_IN_RADIUS][0] + timeFactor * in[TF_IN_RADIUS][1];
      }
    };
    tables.model().switching = [](In in, Out out, Mask mask) {
      for (int i = 0; i < count; ++i)
        if (selected(mask, i)) {
          out[0][i] = i + 1 - in[TF_IN_Q][0] - timeFactor * in[TF_IN_TIME][0];
          out[1][i] = -in[TF_IN_V][0] - timeFactor;
        }
    };
  }
};

template <int timeFactor> struct Screened {
  Walls<timeFactor> walls;
  ContactScales scales{walls.tables.model()};
  GapScreen screen{walls.tables.model(), scales};
  std::vector<double> gaps = std::vector<double>(16);

  void renew(double time, double x, double rate) {
    std::array<const double *, TF_IN_COUNT> in{};
    in[TF_IN_TIME] = &time;
    in[TF_IN_Q] = &x;
    screen.renew(in.data(), &rate, gaps.data());
  }
  [[nodiscard]] int awake() const {
    int number = 0;
    for (int i = 0; i < 16; ++i)
      number += screen.isAwake(i) ? 1 : 0;
    return number;
  }
};

TEST(GapScreen, AllAreAwakeUntilThereIsABox) {
  Screened<0> far;
  EXPECT_TRUE(far.screen.isUsed());
  EXPECT_FALSE(far.screen.covers(0.0, std::array{0.0}.data()));
  EXPECT_EQ(far.awake(), 16);
}

// Whatever point of the box: those that sleep are open there.
TEST(GapScreen, SleepersAreOpenAllOverTheBox) {
  Screened<0> far;
  double x = 0;
  for (int k = 0; k < 200; ++k, x += 0.05) {
    if (!far.screen.covers(0.05 * k, &x))
      far.renew(0.05 * k, x, 1);
    ASSERT_TRUE(far.screen.covers(0.05 * k, &x));
    far.screen.count();
    for (int i = 0; i < 16; ++i) {
      const double gap = i + 1 - x;
      ASSERT_TRUE(gap > 0 || far.screen.isAwake(i)) << x;
      ASSERT_TRUE(std::abs(gap) > 1e-7 || far.screen.isAwake(i)) << x;
    }
  }
}

TEST(GapScreen, FarContactsSleep) {
  Screened<0> far;
  far.renew(0, -1000, 1);
  EXPECT_EQ(far.awake(), 0);
  EXPECT_NEAR(far.gaps[0], 1001, 1e-12);
}

TEST(GapScreen, HeldContactsAreAwake) {
  Screened<0> far;
  far.renew(0, -1000, 1);
  std::vector<std::uint8_t> closed(16, 0);
  closed[3] = 1;
  const long long before = far.screen.revision();
  far.screen.hold(closed.data());
  EXPECT_NE(far.screen.revision(), before);
  EXPECT_TRUE(far.screen.isAwake(3));
  EXPECT_EQ(far.awake(), 1);
  far.screen.hold(closed.data());
  EXPECT_EQ(far.screen.revision(), before + 1);
}

TEST(GapScreen, TimeLeavesTheBoxWhereGapsDependOnIt) {
  Screened<1> moving;
  Screened<0> still;
  const double x = -1000;
  moving.renew(0, x, 0.1);
  still.renew(0, x, 0.1);
  EXPECT_TRUE(still.screen.covers(1e9, &x));
  EXPECT_TRUE(moving.screen.covers(0.0, &x));
  EXPECT_FALSE(moving.screen.covers(1e9, &x));
}

TEST(GapScreen, AStepIsCoveredAsAWhole) {
  Screened<0> far;
  far.renew(0, 0, 0.01);
  const std::array center{4.0, 0.5}, radius{4.5, 0.5};
  EXPECT_FALSE(far.screen.covers(center.data(), radius.data()));
  std::array<const double *, TF_IN_COUNT> in{};
  const double time = 1, x = 8, rate = 0.01;
  in[TF_IN_TIME] = &time;
  in[TF_IN_Q] = &x;
  far.screen.renew(in.data(), &rate, far.gaps.data(), center.data(), radius.data());
  EXPECT_TRUE(far.screen.covers(center.data(), radius.data()));
  for (int i = 0; i < 8; ++i)
    EXPECT_TRUE(far.screen.isAwake(i)) << i;
  EXPECT_FALSE(far.screen.isAwake(15));
}

// All gaps may be read anywhere, as where a prediction ends: back inside the box those that sleep are open again.
TEST(GapScreen, SleepersAreOpenAfterAllWereReadElsewhere) {
  Walls<0> walls;
  const tf_model &model = walls.tables.model();
  const InputSignals inputs(model.nu);
  ModelEvaluation at(model, inputs);
  std::vector<double> here(at.stateSize(), 0.0), beyond = here;
  here[0] = -1000;
  beyond[0] = 8.5;
  at.setPoint(0, here.data());
  at.switching();
  ASSERT_FALSE(at.screen().isAwake(0));
  at.setPoint(1, beyond.data());
  at.switchingOfAll();
  EXPECT_LT(at.gap[0], 0);
  at.setPoint(0, here.data());
  at.switching(ModelEvaluation::Conditions);
  at.switching(ModelEvaluation::Gaps);
  for (int i = 0; i < 16; ++i)
    EXPECT_GT(at.gap[i], 0) << i;
}

TEST(GapScreen, WhatIsNotANumberIsAwake) {
  Screened<0> far;
  far.renew(0, std::nan(""), 1);
  EXPECT_EQ(far.awake(), 16);
}

}  // namespace
