// Reference solution of a rigid body in the plane whose corners touch a rough floor (restitution 0).
#pragma once

#include "tests/accuracy/support/contact_reference.h"

#include <vector>

namespace tf::test {

struct FloorBody {
  Number mass = 1, inertia = 1, mu = 0, g = Number(9.81);
  std::vector<std::pair<Number, Number>> corners;  // in the body's frame
  State<6> start{};                                // x, y, phi and their rates
};

using FloorSolution = ContactSolution<3>;

[[nodiscard]] FloorSolution solve(const FloorBody &body, const std::vector<double> &grid);

}  // namespace tf::test
