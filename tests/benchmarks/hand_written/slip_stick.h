// A point mass falls on a rough floor, slides and sticks: the event-driven program that an engineer would write for this one problem.
#pragma once

namespace tf::hand_written {

struct SlipStick {
  double mu = 0.3, g = 10, force = 2;        // unit mass
  double height = 1, velocity = 1, end = 2;  // initial height and horizontal velocity, final time
};

struct SlipStickResult {
  double x = 0, y = 0, vx = 0, vy = 0;  // at the final time
  double impact = -1, stick = -1;       // times of the events, -1 where there was none
};

[[nodiscard]] SlipStickResult simulate(const SlipStick &problem, double tolerance);

}  // namespace tf::hand_written
