// Numbers of no regularity, by which sums of products tell different rows of numbers apart (the sequence of the golden ratio).
#pragma once

#include <cmath>

namespace tf::runtime {

// The k-th one, in [1, 2).
inline double irregularNumber(int k) {
  constexpr double goldenRatio = 1.618033988749895;
  return 1 + std::fmod(goldenRatio * k, 1.0);
}

}  // namespace tf::runtime
