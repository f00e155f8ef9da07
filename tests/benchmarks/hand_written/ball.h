// A ball bounces on a hard floor, through the accumulation of its impacts into rest: the event-driven program that an engineer would write
// for this one problem.
#pragma once

namespace tf::hand_written {

struct Ball {
  double g = 9.81, restitution = 0.8, height = 1, end = 3;
};

struct BallResult {
  double y = 0, v = 0;  // at the final time
  double rest = -1;     // time at which it came to rest, -1 where it did not
  int impacts = 0;
};

// Impacts slower than tolerance times the first one are no longer followed: the ball rests.
[[nodiscard]] BallResult simulate(const Ball &ball, double tolerance);

}  // namespace tf::hand_written
