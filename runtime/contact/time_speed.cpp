#include "runtime/contact/time_speed.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tf::runtime {

namespace {

// Of the contacts that are loaded: their λ_i/a_i into `ratios`.
double timeSpeedOf(std::span<const double> normalForce, std::span<const double> rate, std::vector<double> &ratios) {
  ratios.clear();
  double largest = 0, sum = 0;
  for (std::size_t i = 0; i < normalForce.size(); ++i) {
    const double ratio = std::max(normalForce[i], 0.0) / rate[i];
    if (ratio == 0)
      continue;
    ratios.push_back(ratio);
    largest = std::max(largest, ratio);
    sum += ratio;
  }
  if (ratios.size() <= 1)
    return 1 / (1 + largest);
  if (ratios.size() == 2) {
    // p r β² − (1 + p + r) β + 1 = 0, the smaller root; its discriminant without cancellation.
    const double other = sum - largest, difference = largest - other;
    return 2 / (1 + sum + std::sqrt(1 + 2 * sum + difference * difference));
  }

  // h(β) = Π_i (1 − β λ_i/a_i) − β is decreasing and convex on the interval: each factor is, and all are positive. Newton from the left
  // of the root therefore increases monotonically towards it. Π (1 − x_i) ≥ 1 − Σ x_i gives such a start, 1/(1 + Σ λ_i/a_i).
  double beta = 1 / (1 + sum);
  for (int iteration = 0; iteration < 100; ++iteration) {
    double product = 1, logarithmicSlope = 0;
    for (const double ratio : ratios) {
      const double factor = 1 - beta * ratio;
      product *= factor;
      logarithmicSlope -= ratio / factor;
    }
    const double next = beta - (product - beta) / (product * logarithmicSlope - 1);
    if (!(next > beta) || next * largest >= 1)
      break;
    const bool converged = next - beta <= 2 * std::numeric_limits<double>::epsilon() * next;
    beta = next;
    if (converged)
      break;
  }
  return beta;
}

}  // namespace

double timeSpeed(std::span<const double> normalForce, std::span<const double> rate) {
  std::vector<double> ratios;
  return timeSpeedOf(normalForce, rate, ratios);
}

double numericalTimeRate(std::span<const double> normalForce, std::span<const double> rate, std::vector<double> &ratios) {
  if (normalForce.empty())
    return 1;
  if (normalForce.size() > 2)
    return 1 / timeSpeedOf(normalForce, rate, ratios);
  const double first = normalForce[0] / rate[0];
  if (normalForce.size() == 1)
    return 1 + first;
  const double second = normalForce[1] / rate[1], sum = first + second, difference = first - second;
  return 0.5 * (1 + sum + std::sqrt(std::max(1 + 2 * sum + difference * difference, 0.0)));
}

void pushes(std::span<const double> normalForce, std::span<const double> rate, double timeSpeed, std::span<double> push) {
  for (std::size_t i = 0; i < normalForce.size(); ++i)
    push[i] = std::max(normalForce[i], 0.0) * timeSpeed / rate[i];
}

double slipStepVariable(double tangentForce, double limit) {
  if (!(limit > 0))
    return 0.5;
  return std::clamp(0.5 * (1 - tangentForce / limit), 0.0, 1.0);
}

}  // namespace tf::runtime
