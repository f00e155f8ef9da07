#pragma once

#include <limits>

namespace tf::runtime {

// Sums of terms of a magnitude are zero below this part of it: they differ from zero by rounding only.
inline constexpr double roundingOfSums = 32 * std::numeric_limits<double>::epsilon();

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace tf::runtime
