// A rigid body in the plane that falls on a rough floor with its corners (restitution 0): event-driven, with the modes that a body on a
// flat floor has: flight, sliding on one corner, sliding on two corners, rest. Impacts as theory.md section 3 with equal rates.
#pragma once

#include "tests/benchmarks/hand_written/dormand_prince.h"

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace tf::hand_written {

struct Corner {
  double x = 0, y = 0;  // in the frame of the body
};

struct PlanarBody {
  double mass = 1, inertia = 1, mu = 0, g = 9.81;
  std::vector<Corner> corners;
  std::array<double, 3> position{};  // x, y, phi
  std::array<double, 3> velocity{};
  double end = 1;
};

struct BodyEvent {
  double time = 0;
  int corner = 0;     // that touched; -1 where the body came to rest
  Vector<6> state{};  // after the event
};

struct BodyResult {
  Vector<6> state{};  // x, y, phi and their rates at the final time
  std::array<BodyEvent, 16> events{};
  int eventCount = 0;
};

// The falling rod and the falling box of the reference trajectories.
[[nodiscard]] PlanarBody fallingRod();
[[nodiscard]] PlanarBody fallingBox();

// Times of `grid` (ascending) are sampled into `samples`, if given, right-continuous at jumps.
[[nodiscard]] BodyResult simulate(const PlanarBody &body, double tolerance, std::span<const double> grid = {},
                                  std::vector<Vector<6>> *samples = nullptr);

}  // namespace tf::hand_written
