// Derivatives by differences, of what a run of the model is.
#pragma once

#include "runtime/simulate/sensitivities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace tf::runtime {

// Of a difference, relative to the magnitude of what changes: rounding 1e-16 / 1e-4, truncation (1e-4)⁴.
inline constexpr double differenceStep = 1e-4;

// Places of five values of a function of s, in steps, and their weights in its derivative at s = 0.
struct DifferenceFormula {
  std::array<double, 5> places, weights, lower;  // lower: of order 2, the others of order 4
};

template <class Function>
std::optional<Sensitivities::DifferenceError> Sensitivities::differenceAt(const Function &function, double h, const double *magnitudes,
                                                                          int count, double *derivative) {
  static constexpr std::array<DifferenceFormula, 3> formulas = {{
      {{-2, -1, 0, 1, 2}, {1.0 / 12, -2.0 / 3, 0, 2.0 / 3, -1.0 / 12}, {0, -0.5, 0, 0.5, 0}},
      {{0, 1, 2, 3, 4}, {-25.0 / 12, 4, -3, 4.0 / 3, -0.25}, {-1.5, 2, -0.5, 0, 0}},
      {{0, -1, -2, -3, -4}, {25.0 / 12, -4, 3, -4.0 / 3, 0.25}, {1.5, -2, 0.5, 0, 0}},
  }};
  constexpr double rounding = 32 * std::numeric_limits<double>::epsilon();
  samples_.resize(5 * static_cast<std::size_t>(count));
  const auto sample = [&](std::size_t k) { return samples_.data() + k * static_cast<std::size_t>(count); };
  const auto isKnown = [&](const DifferenceFormula &formula) {
    for (std::size_t k = 0; k < formula.places.size(); ++k)
      if (formula.weights[k] != 0 && !function(formula.places[k] * h, sample(k)))
        return false;
    return true;
  };
  const auto formula = std::find_if(formulas.begin(), formulas.end(), isKnown);
  if (formula == formulas.end())
    return std::nullopt;
  DifferenceError error;
  for (int i = 0; i < count; ++i) {
    // The weights add up to zero: what does not change has no rounding errors then.
    double high = 0, low = 0, size = 0,
           largest = std::max(magnitudes != nullptr ? magnitudes[i] : 0, std::abs(samples_[static_cast<std::size_t>(i)]));
    for (std::size_t k = 1; k < formula->places.size(); ++k) {
      if (formula->weights[k] == 0)
        continue;
      const double change = (sample(k)[i] - samples_[static_cast<std::size_t>(i)]) / h;
      high += formula->weights[k] * change;
      low += formula->lower[k] * change;
      size = std::max(size, std::abs(change));
      largest = std::max(largest, std::abs(sample(k)[i]));
    }
    derivative[i] = high;
    const double rounded = rounding * largest / h;
    if (std::isfinite(high) && size <= 4 * rounded)
      continue;
    // Orders 2 and 4 are off by about (h/L)² and (h/L)⁴ of a function that changes over L.
    const double off = std::max(0.0, std::abs(high - low) - rounded) / size;
    const double truncated = std::isfinite(high) ? std::min(1.0, off * off) : 1;
    error.truncation = std::max(error.truncation, truncated);
    error.total = std::max(error.total, truncated < 1 ? truncated + rounded / size : 1);
  }
  return error;
}

template <class Function> bool Sensitivities::difference(const Function &function, double scale, int count, double *derivative) {
  return differenceAt(function, differenceStep / scale, nullptr, count, derivative).has_value();
}

template <class Function>
std::optional<double> Sensitivities::differenceOfSmooth(const Function &function, double scale, const double *magnitudes, int count,
                                                        double *derivative) {
  // Truncation errors: one that no shorter step is tried for; one up to which it tells the function's scale, so that the next step is to
  // have the difference `aim` between orders 2 and 4. Of the steps' lengths: the shortest and the longest part of the one before. What is
  // won is worth a further step where the error falls to this part of it.
  constexpr double good = 1e-11, unknown = 1e-2, aim = 1e-6, shortest = 1e-3, longest = 0.1, worthwhile = 0.25;
  constexpr int mostPasses = 6;
  double h = differenceStep / scale, shortening = 1;
  std::optional<DifferenceError> error = differenceAt(function, h, magnitudes, count, derivative);
  finer_.resize(static_cast<std::size_t>(count));
  for (int pass = 0; pass < mostPasses && !(error && error->truncation <= good); ++pass) {
    // Far beyond a function's own scale nothing tells how far.
    const bool isKnown = error && error->truncation < unknown;
    h *= isKnown ? std::clamp(std::sqrt(aim / std::sqrt(error->truncation)), shortest, longest) : shortest;
    const std::optional<DifferenceError> finer = differenceAt(function, h, magnitudes, count, finer_.data());
    const bool isBetter = finer && !(error && finer->total >= error->total);
    if (isKnown && !(isBetter && finer->total <= worthwhile * error->total))
      break;
    if (isBetter) {
      error = finer;
      shortening = differenceStep / (scale * h);
      std::copy_n(finer_.begin(), count, derivative);
    }
  }
  return error ? std::optional(shortening) : std::nullopt;
}

}  // namespace tf::runtime
