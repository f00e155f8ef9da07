// Reference solution of a rigid body in the plane whose corners touch a rough floor (restitution 0), for any sequence of modes:
// event-driven, with the mode after every event found by trying all of them. Slow, and independent of the project's contact solvers.
#pragma once

#include "tests/accuracy/gauss_reference.h"

#include <optional>
#include <vector>

namespace tf::test {

struct FloorBody {
  Number mass = 1, inertia = 1, mu = 0, g = Number(9.81);
  std::vector<std::pair<Number, Number>> corners;  // in the body's frame
  State<6> start{};                                // x, y, phi and their rates
};

struct FloorSolution {
  std::vector<State<6>> samples;  // at the grid's times
  Number validUntil = 0;          // beyond it impacts accumulate, or the next mode is not unique
  int events = 0;
  std::vector<Number> eventTimes;
  int redundantModes = 0, reversals = 0, openings = 0, sticks = 0;  // what the motion went through
};

[[nodiscard]] FloorSolution solve(const FloorBody &body, const std::vector<double> &grid);

}  // namespace tf::test
