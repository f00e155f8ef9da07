#pragma once

#include <vector>

namespace tf::runtime {

[[nodiscard]] inline bool allFinite(const double *values, int count) {
  double sum = 0;  // infinities and NaN survive multiplication by zero and addition
  for (int i = 0; i < count; ++i)
    sum += values[i] * 0;
  return sum == 0;
}

[[nodiscard]] inline bool allFinite(const std::vector<double> &values) { return allFinite(values.data(), static_cast<int>(values.size())); }

}  // namespace tf::runtime
