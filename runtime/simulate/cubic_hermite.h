// The cubic on [0, h] with given values and slopes at both ends, by the place s = x/h in [0, 1].
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

struct CubicHermite {
  double begin, beginSlope, end, endSlope, length;  // slopes by x

  [[nodiscard]] double value(double s) const {
    const double r = 1 - s;
    return r * r * (1 + 2 * s) * begin + s * s * (3 - 2 * s) * end + length * s * r * (r * beginSlope - s * endSlope);
  }

  // By s.
  [[nodiscard]] double slope(double s) const {
    return 6 * s * (1 - s) * (end - begin) + length * ((1 - s) * (1 - 3 * s) * beginSlope + s * (3 * s - 2) * endSlope);
  }

  // The least value inside (0, 1), infinity where there is no interior minimum.
  [[nodiscard]] double interiorMinimum() const {
    // Derivative by s: 3 p s² + 2 q s + r.
    const double p = 2 * (begin - end) + length * (beginSlope + endSlope);
    const double q = 3 * (end - begin) - length * (2 * beginSlope + endSlope);
    const double r = length * beginSlope;
    const double discriminant = q * q - 3 * p * r;
    if (discriminant < 0)
      return std::numeric_limits<double>::infinity();
    const double root = std::sqrt(discriminant);
    // The minimum is the root where the second derivative is positive.
    const double s = q + root != 0 ? -r / (q + root) : std::numeric_limits<double>::infinity();
    return s > 0 && s < 1 ? value(s) : std::numeric_limits<double>::infinity();
  }

  // The place in (0, 1) where the cubic falls through zero for the last time before its end, which is negative and falling: that of a
  // parabola where it is one, else by Newton's method from there, to 1e-10 or so. −1: it does not converge.
  [[nodiscard]] double lastZero() const {
    constexpr double rounding = 1e-14;
    const double start = length * beginSlope, bend = end - begin - start;
    if (std::abs(2 * (begin - end) + length * (beginSlope + endSlope)) <= rounding * std::abs(bend) && bend < 0) {
      const double root = std::sqrt(start * start - 4 * bend * begin);
      return start > 0 ? (start + root) / (-2 * bend) : 2 * begin / (root - start);
    }
    double s = 1;
    for (int k = 0; k < 12; ++k) {
      const double rise = slope(s), step = -value(s) / rise;
      if (!(rise < 0) || !(s + step > 0) || !(s + step <= 1))
        return -1;
      s += step;
      if (std::abs(step) <= 1e-5)
        return s;
    }
    return -1;
  }

  // The least value of (value(s) − begin)/s on [0, 1].
  [[nodiscard]] double leastSecant() const {
    const double first = length * beginSlope, last = end - begin;
    const double p = 2 * (begin - end) + length * (beginSlope + endSlope);
    const double q = 3 * (end - begin) - length * (2 * beginSlope + endSlope);
    // first + q s + p s²
    const double s = p > 0 ? -q / (2 * p) : -1;
    const double inside = s > 0 && s < 1 ? first + 0.5 * q * s : std::numeric_limits<double>::infinity();
    return std::min(inside, std::min(first, last));
  }
};

}  // namespace tf::runtime
