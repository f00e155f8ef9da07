#include "runtime/integrate/hermite_interpolation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

// Derivatives of integrals: the cubic with their rates at both ends, and the multiple of s²(1 − s)² that makes its integral end at the
// integral's end (Hermite interpolation of degree 5; Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section II.6).
void interpolateBetween(const StepEnds &step, double theta, double *y) {
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  const auto [begin, beginRate, end, endRate, h, size, count] = step;
  const double r = 1 - theta, t2 = theta * theta, t3 = t2 * theta, t4 = t2 * t2;
  const double cubic = t2 * (3 - 2 * theta), slope0 = theta * r * r, slope1 = -t2 * r;
  const double cubicIntegral = t3 - t4 / 2, slope0Integral = t2 / 2 - 2 * t3 / 3 + t4 / 4, slope1Integral = t4 / 4 - t3 / 3;
  const double bump = 30 * t2 * r * r, bumpIntegral = t3 * (10 - 15 * theta + 6 * t2);
  for (int i = 0; i < count; ++i) {
    const int v = count + i;
    const double q0 = begin[i], q1 = end[i], v0 = begin[v], dv = end[v] - v0, w0 = h * beginRate[v], w1 = h * endRate[v];
    const double rest = (q1 - q0) - h * (v0 + dv / 2 + (w0 - w1) / 12);
    y[i] = q0 + h * (v0 * theta + cubicIntegral * dv + slope0Integral * w0 + slope1Integral * w1) + bumpIntegral * rest;
    y[v] = v0 + cubic * dv + slope0 * w0 + slope1 * w1;
    if (std::abs(rest) > rounding * std::max(std::abs(q0), std::abs(q1)))
      y[v] += bump * rest / h;
  }
  for (int i = 2 * count; i < size; ++i)
    y[i] = begin[i] + cubic * (end[i] - begin[i]) + h * (slope0 * beginRate[i] + slope1 * endRate[i]);
}

}  // namespace tf::runtime
