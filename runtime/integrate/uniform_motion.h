// Elements of motions whose accelerations are constant: parabolas, exact over any length.
#pragma once

#include "runtime/integrate/element_method.h"

namespace tf::runtime {

class UniformMotion final : public ElementMethod {
public:
  explicit UniformMotion(int size) : ElementMethod(size) {}

  // y0 and f0 must stay until the next element.
  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  void interpolate(double theta, double *y) override { at(theta * h_, y); }
  [[nodiscard]] double errorNorm(const double * /*scale*/, double /*tolerance*/) const override { return 0; }
  [[nodiscard]] double errorOrder() const override { return 1; }
  [[nodiscard]] int interiorStages() const override { return 0; }

private:
  void at(double time, double *y) const;

  const double *begin_ = nullptr, *rate_ = nullptr;
  int nq_ = 0, nv_ = 0;
  double h_ = 0;
};

}  // namespace tf::runtime
