// Derivatives by differences, of what a run of the model is.
#pragma once

#include "runtime/simulate/sensitivities.h"

#include <array>

namespace tf::runtime {

// Of a difference, relative to the magnitude of what changes: rounding 1e-16 / 1e-4, truncation (1e-4)⁴.
inline constexpr double differenceStep = 1e-4;

template <class Function> bool Sensitivities::difference(const Function &function, double scale, int count, double *derivative) {
  const double h = differenceStep / scale;
  samples_.resize(5 * static_cast<std::size_t>(count));
  const auto sum = [&](const std::array<double, 5> &places, const std::array<double, 5> &weights) {
    for (std::size_t k = 0; k < places.size(); ++k)
      if (weights[k] != 0 && !function(places[k] * h, samples_.data() + k * static_cast<std::size_t>(count)))
        return false;
    // The weights add up to zero: what does not change has no rounding errors then.
    for (int i = 0; i < count; ++i) {
      derivative[i] = 0;
      for (std::size_t k = 1; k < places.size(); ++k)
        if (weights[k] != 0)
          derivative[i] += weights[k] * (samples_[k * static_cast<std::size_t>(count) + static_cast<std::size_t>(i)] - samples_[i]) / h;
    }
    return true;
  };
  return sum({-2, -1, 0, 1, 2}, {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12}) || sum({0, 1, 2, 3, 4}, {-25.0 / 12, 4, -3, 4.0 / 3, -0.25}) ||
         sum({0, -1, -2, -3, -4}, {25.0 / 12, -4, 3, -4.0 / 3, 0.25});
}

}  // namespace tf::runtime
