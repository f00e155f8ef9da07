#pragma once

#include <vector>

namespace tf::runtime {

[[nodiscard]] inline bool allFinite(const double *values, int count) {
  double sum = 0, other = 0;  // infinities and NaN survive multiplication by zero and addition
  int i = 0;
  for (; i + 1 < count; i += 2) {
    sum += values[i] * 0;
    other += values[i + 1] * 0;
  }
  for (; i < count; ++i)
    sum += values[i] * 0;
  return sum + other == 0;
}

// Copies, and returns 0 if all values are finite, else NaN.
[[nodiscard]] inline double copyFinite(const double *values, int count, double *target) {
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    target[i] = values[i];
    sum += values[i] * 0;
  }
  return sum;
}

[[nodiscard]] inline bool allFinite(const std::vector<double> &values) { return allFinite(values.data(), static_cast<int>(values.size())); }

}  // namespace tf::runtime
