// The explicit method of Dormand and Prince of order 8 with error estimates of orders 5 and 3 and dense output of order 7 (DOP853: Hairer,
// Nørsett, Wanner, Solving Ordinary Differential Equations I, II.5, II.6 and II.10). For tight tolerances.
#pragma once

#include "runtime/integrate/explicit_method.h"
#include "runtime/integrate/inside_states.h"

namespace tf::runtime {

class DormandPrince8 final : public ExplicitMethod {
public:
  // Its elements are for this tolerance.
  DormandPrince8(int size, double tolerance);

  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  // The first call after an element evaluates the dynamics at four more points, and at the end again. Where that fails, the cubic through
  // both ends is taken; where they show that the extension does not hold the tolerance (damping that stability limits the step by), it
  // solves shorter elements (InsideStates).
  void interpolate(double theta, double *y) override;
  [[nodiscard]] bool isInterpolantDear() const override { return !hasDense_; }
  [[nodiscard]] double errorNorm(const double *scale, double tolerance) const override;
  [[nodiscard]] double errorOrder() const override { return 8; }
  [[nodiscard]] int interiorStages() const override { return 10; }

private:
  // From (t0_, y0) with the rate f0 to t0_ + h, with its error.
  bool advance(const double *y0, const double *f0, double h);
  void makeDense();
  bool holdsTolerance();
  void solveInside();

  double tolerance_;
  ModeDynamics *dynamics_ = nullptr;
  double t0_ = 0;
  const double *scale_ = nullptr;
  InsideStates inside_;
  std::vector<double> defect_;
};

}  // namespace tf::runtime
