// Reference solution of one mass with dry friction against a moving belt: m x'' = force(t, x, v) + friction, |friction| <= bound, against
// the slip v - belt(t). Event-driven in long double.
#pragma once

#include "tests/accuracy/support/gauss_reference.h"

#include <functional>
#include <vector>

namespace tf::test {

struct DryFriction {
  Number mass = 1, bound = 0;
  std::function<Number(Number t, Number x, Number v)> force;
  std::function<Number(Number t)> belt = [](Number) { return Number(0); };
  std::function<Number(Number t)> beltAcceleration = [](Number) { return Number(0); };
  Number x = 0, v = 0;  // at time 0
  Number step = Number(0.01);
};

struct FrictionSwitch {
  Number time = 0;
  bool sticks = false;  // after it
};

struct FrictionSolution {
  std::vector<State<2>> samples;  // at the grid's times
  std::vector<FrictionSwitch> switches;
};

// `grid`: ascending times, the last one is the end.
[[nodiscard]] FrictionSolution solve(const DryFriction &problem, const std::vector<double> &grid);

}  // namespace tf::test
