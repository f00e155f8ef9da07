// The hand-written programs that the benchmarks compare with solve the problems that they claim to solve.
#include "tests/accuracy/support/compiled_model.h"
#include "tests/benchmarks/hand_written/planar_body.h"
#include "tests/benchmarks/hand_written/slip_stick.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace tf::test {
namespace {

void expectReference(const hand_written::PlanarBody &body, const std::string &name) {
  const std::string base = TF_SOURCE_DIR "/tests/accuracy/reference/" + name;
  const CsvTable grid(base + ".csv"), events(base + "_events.csv");
  std::vector<hand_written::Vector<6>> samples;
  const hand_written::BodyResult result = hand_written::simulate(body, 1e-12, grid["t"], &samples);
  ASSERT_EQ(samples.size(), grid.rows());
  constexpr std::array kColumns = {"x", "y", "th", "vx", "vy", "om"};
  for (std::size_t row = 0; row < grid.rows(); ++row) {
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
      ASSERT_NEAR(samples[row][i], grid[kColumns[i]][row], 2e-9) << kColumns[i] << " at t = " << grid["t"][row];
    }
  }
  // The first row of the events is the start, the last one repeats the stop.
  ASSERT_EQ(result.eventCount, static_cast<int>(events.rows()) - 2);
  for (int i = 0; i < result.eventCount; ++i) {
    EXPECT_NEAR(result.events[static_cast<std::size_t>(i)].time, events["t"][static_cast<std::size_t>(i) + 1], 1e-9) << "event " << i;
  }
}

TEST(HandWritten, RodFollowsTheReference) { expectReference(hand_written::fallingRod(), "S06a_rod"); }

TEST(HandWritten, BoxFollowsTheReference) { expectReference(hand_written::fallingBox(), "S07b_box"); }

TEST(HandWritten, SlipStickHasTheClosedForm) {
  const hand_written::SlipStickResult result = hand_written::simulate(hand_written::SlipStick{}, 1e-9);
  EXPECT_NEAR(result.impact, std::sqrt(0.2), 1e-12);
  EXPECT_NEAR(result.stick, 1, 1e-11);
  EXPECT_NEAR(result.x, 0.8, 1e-11);
  EXPECT_EQ(result.vx, 0);
}

}  // namespace
}  // namespace tf::test
