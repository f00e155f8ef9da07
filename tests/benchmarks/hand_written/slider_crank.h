// Crank, connecting rod and a slider with clearance in a channel (P. Flores, R. Leine, C. Glocker, 2010, without rebound), event-driven:
// flight and sliding of two corners on one of the walls, the modes that this mechanism has.
#pragma once

#include "tests/benchmarks/hand_written/dormand_prince.h"

namespace tf::hand_written {

struct SliderCrank {
  double l1 = 0.153, l2 = 0.306;                 // lengths of crank and rod
  double m1 = 0.038, m2 = 0.038, m3 = 0.076;     // masses of crank, rod and slider
  double j1 = 7.4e-5, j2 = 5.9e-4, j3 = 2.7e-6;  // moments of inertia
  double a = 0.05, b = 0.025, d = 0.026;         // half length and height of the slider, half height of the channel
  double g = 9.81, mu = 0.01, end = 0.1;
  Vector<6> start = {0, 0, 0, 150, -75, 0};  // angles of crank, rod, slider, and their rates
};

struct SliderCrankResult {
  Vector<6> state{};
  int events = 0;
};

[[nodiscard]] SliderCrankResult simulate(const SliderCrank &crank, double tolerance);

}  // namespace tf::hand_written
