#include "runtime/integrate/bogacki_shampine.h"

#include <cmath>
#include <cstddef>
#include <utility>

namespace tf::runtime {

namespace {

// k1 … k3, and k4, dy/dt at the end.
constexpr std::size_t stageCount = 3, storedCount = 4, coefficientCount = 3;

constexpr double nodes[] = {0, 1.0 / 2, 3.0 / 4};
constexpr double weights[3][2] = {{}, {1.0 / 2}, {0, 3.0 / 4}};
constexpr double result[1][3] = {{2.0 / 9, 1.0 / 3, 4.0 / 9}};
constexpr double difference[1][4] = {{-5.0 / 72, 1.0 / 12, 1.0 / 9, -1.0 / 8}};
// A sixteenth of what the midpoint rule differs by: of y' = λ y half of the estimate as h λ goes to zero, and of its size at h λ = −1 too,
// where the estimate is zero and the error 0.03.
constexpr double ofMidpoint[1][3] = {{1.0 / 72, -1.0 / 24, 1.0 / 36}};

}  // namespace

BogackiShampine::BogackiShampine(int size) : ExplicitMethod(size, stageCount, storedCount, coefficientCount, 2.51, 1.53) {}

bool BogackiShampine::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
                            double /*accuracy*/) {
  beginStep(y0, f0, h);
  if (!solveStages<nodes, weights>(dynamics, t0, std::make_index_sequence<stageCount - 1>()))
    return false;
  combine<result, 0, stageCount>(end_.data());
  // The rate at the end serves the next step as well: it is to be that of the projected state.
  if (!dynamics.evaluateProjected(t0 + h, end_.data(), endRate_.data(), scale))
    return false;
  std::copy_n(endRate_.begin(), n_, stage(stageCount));
  const double *k = stages_.data();
  double *error = error_.data();
  for (std::size_t i = 0, stride = stride_; i < stride; i += 2) {
    const Pair first = h * weightedSum<Pair, difference, 0>(k + i, stride, std::make_index_sequence<storedCount>());
    const Pair second = h * weightedSum<Pair, ofMidpoint, 0>(k + i, stride, std::make_index_sequence<stageCount>());
    for (std::size_t lane = 0; lane < 2; ++lane)
      error[i + lane] = std::abs(first[lane]) > std::abs(second[lane]) ? first[lane] : second[lane];
  }
  return true;
}

void BogackiShampine::interpolate(double theta, double *y) {
  if (!hasDense_)
    makeCoefficients<difference, storedCount>(false, std::make_index_sequence<0>());
  evaluateDense<coefficientCount>(theta, y);
}

}  // namespace tf::runtime
