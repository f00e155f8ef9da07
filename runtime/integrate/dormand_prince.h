// The explicit pair of Dormand and Prince of order 5(4) with its dense output of order 4 (J. Comput. Appl. Math. 6, 1980; Hairer, Nørsett,
// Wanner, Solving Ordinary Differential Equations I, II.5–II.6).
#pragma once

#include "runtime/integrate/element_method.h"

namespace tf::runtime {

class DormandPrince final : public ElementMethod {
public:
  explicit DormandPrince(int size);

  void restart() override {}
  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  void interpolate(double theta, double *y) const override;
  [[nodiscard]] double errorNorm(const double *scale, double tolerance) const override;
  // Hairer, Wanner II, IV.2: two evaluations at the end of the step, whose states differ by the local error.
  [[nodiscard]] double stabilityRatio() const override;
  [[nodiscard]] double errorOrder() const override { return 5; }
  [[nodiscard]] int interiorStages() const override { return 4; }

private:
  std::vector<double> stages_;         // k2 … k6, n each
  mutable std::vector<double> dense_;  // coefficients of the dense output, four for each component, once they have been asked for
  mutable bool hasDense_ = false;
  void makeDense() const;
  template <int s> bool solveStage(ModeDynamics &dynamics, double t0);
  std::vector<double> point_, begin_, beginRate_;
  double h_ = 0;
};

}  // namespace tf::runtime
