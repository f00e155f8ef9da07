// The explicit pair of Dormand and Prince of order 5(4) with its dense output of order 4 (J. Comput. Appl. Math. 6, 1980; Hairer, Nørsett,
// Wanner, Solving Ordinary Differential Equations I, II.5–II.6).
#pragma once

#include "runtime/integrate/explicit_method.h"

namespace tf::runtime {

class DormandPrince : public ExplicitMethod {
public:
  explicit DormandPrince(int size);

  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  void interpolate(double theta, double *y) override;
  [[nodiscard]] double errorOrder() const override { return 5; }
  [[nodiscard]] int interiorStages() const override { return 4; }
};

}  // namespace tf::runtime
