#include "runtime/integrate/dormand_prince.h"

#include <cstddef>
#include <utility>

namespace tf::runtime {

namespace {

// k1 … k6, and k7, dy/dt at the end.
constexpr std::size_t stageCount = 6, storedCount = 7, coefficientCount = 4;

constexpr double nodes[] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1};
constexpr double weights[6][5] = {
    {},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
};
constexpr double result[1][6] = {{35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
constexpr double difference[1][7] = {{71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40}};
constexpr double dense[1][7] = {{-12715105075.0 / 11282082432.0, 0, 87487479700.0 / 32700410799.0, -10690763975.0 / 1880347072.0,
                                 701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0, 69997945.0 / 29380423.0}};

}  // namespace

DormandPrince::DormandPrince(int size) : ExplicitMethod(size, stageCount, storedCount, coefficientCount, 3.25, 40) {}

bool DormandPrince::solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
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
  for (std::size_t i = 0, stride = stride_; i < stride; i += 2)
    store(error + i, h * weightedSum<Pair, difference, 0>(k + i, stride, std::make_index_sequence<storedCount>()));
  return true;
}

void DormandPrince::interpolate(double theta, double *y) {
  if (!hasDense_)
    makeCoefficients<dense, storedCount>(true, std::make_index_sequence<1>());
  evaluateDense<coefficientCount>(theta, y);
}

}  // namespace tf::runtime
