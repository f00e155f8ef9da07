#include "runtime/integrate/spectral_radius.h"

#include <algorithm>
#include <cmath>

namespace tf::runtime {

namespace {

// Of a perturbation, relative to the scale: differences of rates are then good to seven digits or so, and the rest is linear.
constexpr double perturbation = 1e-8;
constexpr int mostIterations = 40;
// Relative changes of the estimate that end the iteration.
constexpr double converged = 0.02;
// Of the angle between a direction and its image: a real negative eigenvalue.
constexpr double opposite = -0.95;

}  // namespace

// One multiplication by the Jacobian. False: the dynamics cannot be evaluated nearby.
bool SpectralRadius::iterate(ModeDynamics &dynamics, double time, const double *state, const double *scale) {
  const int n = dynamics.size();
  for (int i = 0; i < n; ++i)
    moved_[i] = state[i] + perturbation * scale[i] * direction_[i];
  if (!dynamics.evaluate(time, moved_.data(), rate_.data()))
    return false;
  double product = 0, image = 0;
  for (int i = 0; i < n; ++i) {
    rate_[i] = (rate_[i] - base_[i]) / scale[i] / perturbation;
    image += rate_[i] * rate_[i];
    product += rate_[i] * direction_[i];
  }
  if (!std::isfinite(image))
    return false;
  growth_ = std::sqrt(image / n);
  cosine_ = growth_ > 0 ? product / (n * growth_) : 0;
  if (growth_ > 0)
    for (int i = 0; i < n; ++i)
      direction_[i] = rate_[i] / growth_;
  return true;
}

// The rate, and something of every direction. Numbers of a regular wave would be nearly an eigenvector of bodies in a row, and the
// iteration would end with its eigenvalue.
void SpectralRadius::seed(const double *rate, const double *scale) {
  const int n = static_cast<int>(direction_.size());
  double largest = 0;
  for (int i = 0; i < n; ++i)
    largest = std::max(largest, std::abs(rate[i]) / scale[i]);
  for (int i = 0; i < n; ++i)
    direction_[i] = (largest > 0 ? rate[i] / scale[i] / largest : 0) + std::cos(1.0 + 2.3 * i * i);
  normalise();
}

// To a mean square of 1.
void SpectralRadius::normalise() {
  double squares = 0;
  for (const double part : direction_)
    squares += part * part;
  const double factor = std::sqrt(static_cast<double>(direction_.size()) / squares);
  for (double &part : direction_)
    part *= factor;
}

void SpectralRadius::suspect(const double *direction, const double *scale) {
  const int n = static_cast<int>(direction_.size());
  double squares = 0;
  for (int i = 0; i < n; ++i)
    squares += direction[i] * direction[i] / (scale[i] * scale[i]);
  isSuspected_ = true;
  const double factor = std::sqrt(n / squares);
  if (!isKnown_ || !std::isfinite(factor) || !(factor > 0))
    return;
  for (int i = 0; i < n; ++i)
    direction_[i] += factor * direction[i] / scale[i];
  normalise();
}

void SpectralRadius::estimate(ModeDynamics &dynamics, double time, const double *state, const double *rate, bool isExact,
                              const double *scale) {
  if (!isKnown_)
    seed(rate, scale);
  // That of a state which has been projected since is not good enough for differences.
  if (!isExact && dynamics.needsProjection())
    dynamics.evaluate(time, state, base_.data());
  else
    std::copy_n(rate, base_.size(), base_.begin());
  // What another mode has left may return with the next one, unless this one's is quite another.
  constexpr double forgetting = 0.95, alike = 0.7;
  const double remembered = isKnown_ ? forgetting * radius_ : 0, like = isKnown_ ? alike * radius_ : 0;
  double before = 0;
  for (int k = 0; k < mostIterations; ++k) {
    if (!iterate(dynamics, time, state, scale))
      break;
    if (k == 0 && isKnown_ && !isSuspected_ && isDamping_ && growth_ >= like && growth_ <= radius_ && cosine_ <= opposite)
      break;
    if (k > 0 && std::abs(growth_ - before) <= converged * growth_ && (cosine_ <= opposite || k > mostIterations / 2))
      break;
    before = growth_;
  }
  isDamping_ = cosine_ <= opposite;
  radius_ = growth_ >= like ? std::max(growth_, remembered) : growth_;
  isKnown_ = true;
  isSuspected_ = false;
}

}  // namespace tf::runtime
