// The largest eigenvalue of the Jacobian of a mode's dynamics, without the Jacobian: the power method on differences of rates (Sommeijer,
// Shampine, Verwer, RKC: an explicit solver for parabolic PDEs, J. Comput. Appl. Math. 88, 1998).
#pragma once

#include "runtime/integrate/mode_dynamics.h"

#include <vector>

namespace tf::runtime {

class SpectralRadius {
public:
  explicit SpectralRadius(int size) : direction_(size), moved_(size), base_(size), rate_(size) {}

  // Estimates it at (time, state), with the rate there, or about it unless `isExact`, in the norm that `scale` [n] gives. What it found
  // before, in this mode or another one, is where it begins, and one evaluation is enough where that has grown no larger.
  void estimate(ModeDynamics &dynamics, double time, const double *state, const double *rate, bool isExact, const double *scale);
  // A direction that grows too fast: the next estimate goes to the end with it.
  void suspect(const double *direction, const double *scale);

  // What it found before.
  void forget() { isKnown_ = isSuspected_ = false; }

  [[nodiscard]] bool isKnown() const { return isKnown_; }
  // An upper bound by experience, in 1/s: the margin is for eigenvalues nearby that the iteration has not separated.
  [[nodiscard]] double bound() const { return 1.15 * radius_; }
  // The eigenvalue is real and negative, as those of damping.
  [[nodiscard]] bool isDamping() const { return isDamping_; }

private:
  bool iterate(ModeDynamics &dynamics, double time, const double *state, const double *scale);
  void seed(const double *rate, const double *scale);
  void normalise();

  std::vector<double> direction_, moved_, base_, rate_;  // direction_: in units of scale
  double radius_ = 0;
  double growth_ = 0, cosine_ = 0;  // of the last iteration
  bool isKnown_ = false, isSuspected_ = false, isDamping_ = true;
};

}  // namespace tf::runtime
