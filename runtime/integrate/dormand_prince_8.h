// The explicit method of Dormand and Prince of order 8 with error estimates of orders 5 and 3 and dense output of order 7 (DOP853: Hairer,
// Nørsett, Wanner, Solving Ordinary Differential Equations I, II.5, II.6 and II.10). For tight tolerances.
#pragma once

#include "runtime/integrate/explicit_method.h"

namespace tf::runtime {

class DormandPrince8 final : public ExplicitMethod {
public:
  explicit DormandPrince8(int size);

  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  // The first call after an element evaluates the dynamics at three more points, and at the end again; where that fails, the cubic through
  // both ends is taken.
  void interpolate(double theta, double *y) const override;
  [[nodiscard]] bool isInterpolantDear() const override { return !hasDense_; }
  [[nodiscard]] double errorOrder() const override { return 8; }
  [[nodiscard]] int interiorStages() const override { return 10; }

private:
  void makeDense() const;

  ModeDynamics *dynamics_ = nullptr;
  double t0_ = 0;
};

}  // namespace tf::runtime
