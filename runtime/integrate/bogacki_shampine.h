// The explicit pair of Bogacki and Shampine of order 3(2) with the cubic through both ends (Appl. Math. Lett. 2, 1989).
#pragma once

#include "runtime/integrate/explicit_method.h"

namespace tf::runtime {

class BogackiShampine : public ExplicitMethod {
public:
  explicit BogackiShampine(int size);

  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  void interpolate(double theta, double *y) override;
  [[nodiscard]] double errorOrder() const override { return 3; }
  [[nodiscard]] int interiorStages() const override { return 2; }
};

}  // namespace tf::runtime
