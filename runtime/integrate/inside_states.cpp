#include "runtime/integrate/inside_states.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace tf::runtime {

// Chebyshev's, at which errors of the states are hardly amplified.
InsideStates::InsideStates(int size, int count) : size_(size), places_(count + 2), states_(static_cast<std::size_t>(size) * count) {
  for (int k = 0; k <= count + 1; ++k)
    places_[k] = (1 - std::cos(std::numbers::pi * k / (count + 1))) / 2;
}

void InsideStates::solve(const SolveTo &solveTo) {
  status_ = Status::Known;
  for (std::size_t k = 1; k + 1 < places_.size() && status_ == Status::Known; ++k)
    if (!solveTo(places_[k], states_.data() + (k - 1) * size_))
      status_ = Status::Unsolvable;
}

// The barycentric formula (Berrut, Trefethen, Barycentric Lagrange interpolation, SIAM Review 46, 2004).
void InsideStates::interpolate(double theta, const double *begin, const double *end, double *y) const {
  const std::size_t last = places_.size() - 1;
  std::fill_n(y, size_, 0.0);
  double sum = 0;
  for (std::size_t k = 0; k <= last; ++k) {
    const double *state = k == 0 ? begin : k == last ? end : states_.data() + (k - 1) * size_;
    const double distance = theta - places_[k];
    if (distance == 0) {
      std::copy_n(state, size_, y);
      return;
    }
    const double weight = (k % 2 == 0 ? 1 : -1) * (k == 0 || k == last ? 0.5 : 1.0) / distance;
    sum += weight;
    for (int i = 0; i < size_; ++i)
      y[i] += weight * state[i];
  }
  for (int i = 0; i < size_; ++i)
    y[i] /= sum;
}

}  // namespace tf::runtime
