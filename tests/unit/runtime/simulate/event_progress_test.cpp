#include "runtime/simulate/event_progress.h"

#include <gtest/gtest.h>

namespace tf::runtime {
namespace {

int eventsUntilGivenUp(double time, double distance, int most) {
  EventProgress progress;
  progress.start(time, 3);
  int count = 0;
  while (count < most && progress.add(time + count * distance))
    ++count;
  return count;
}

TEST(EventProgress, GivesUpWhereEventsNeitherEndNorMoveTime) { EXPECT_LT(eventsUntilGivenUp(2.5, 0, 100000), 5000); }

TEST(EventProgress, GivesUpWhereProgressIsTiny) {
  EXPECT_LT(eventsUntilGivenUp(0.5, 1e-11, 100000), 5000);
  EXPECT_LT(eventsUntilGivenUp(1e6, 1e-9, 100000), 5000);
}

TEST(EventProgress, ManyElementsMayHaveManyEvents) {
  EventProgress progress;
  progress.start(1, 100);
  for (int k = 0; k < 10000; ++k)
    ASSERT_TRUE(progress.add(1)) << k;
}

TEST(EventProgress, FastSwitchingGoesOn) {
  EXPECT_EQ(eventsUntilGivenUp(0, 1e-8, 100000), 100000);
  EXPECT_EQ(eventsUntilGivenUp(3600, 1e-6, 100000), 100000);
}

// A run that begins at a large time is as long as another one.
TEST(EventProgress, FastSwitchingGoesOnFarFromZero) {
  EXPECT_EQ(eventsUntilGivenUp(1e6, 1e-6, 100000), 100000);
  EXPECT_EQ(eventsUntilGivenUp(1.7e9, 1e-5, 100000), 100000);
}

TEST(EventProgress, ABurstOfEventsAtOneTimeGoesOn) {
  EventProgress progress;
  progress.start(0, 3);
  for (int burst = 1; burst <= 100; ++burst)
    for (int k = 0; k < 300; ++k)
      ASSERT_TRUE(progress.add(burst)) << burst;
}

TEST(SwitchProgress, GivesUpWhereASwitchNeverLeavesRounding) {
  SwitchProgress progress;
  progress.start(2);
  int count = 0;
  while (count < 10000 && progress.add(1, count % 2 == 0 ? 1e-12 : -1e-12))
    ++count;
  EXPECT_GT(count, 10);
  EXPECT_LT(count, 1000);
  EXPECT_TRUE(progress.add(0, 1e-12));
}

TEST(SwitchProgress, OneThatHasLeftItGoesOn) {
  SwitchProgress progress;
  progress.start(1);
  for (int k = 0; k < 10000; ++k)
    ASSERT_TRUE(progress.add(0, k % 50 == 0 ? 1e-9 : 1e-12)) << k;
}

}  // namespace
}  // namespace tf::runtime
