#pragma once

#include <limits>

namespace tf::runtime {

// Sums of terms of a magnitude are zero below this part of it: they differ from zero by rounding only.
inline constexpr double roundingOfSums = 32 * std::numeric_limits<double>::epsilon();
// Accelerations of an impact below this part of what they are sums of are zero where all of them are.
inline constexpr double standstill = 1e-9;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace tf::runtime
