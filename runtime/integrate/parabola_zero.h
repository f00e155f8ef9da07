// When a gap with a constant acceleration falls to zero.
#pragma once

#include "runtime/contact/numbers.h"

#include <cmath>

namespace tf::runtime {

// The first t > 0 with gap + rate t + acceleration t²/2 = 0, infinity if there is none; a gap of zero opens first.
inline double parabolaZero(double gap, double rate, double acceleration) {
  if (gap <= 0)
    return rate > 0 && acceleration < 0 ? -2 * rate / acceleration : infinity;
  const double discriminant = rate * rate - 2 * acceleration * gap;
  const double sum = discriminant >= 0 ? std::sqrt(discriminant) - rate : 0;
  return sum > 0 ? 2 * gap / sum : infinity;
}

}  // namespace tf::runtime
