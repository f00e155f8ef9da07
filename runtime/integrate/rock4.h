// The stabilised explicit method ROCK4 of order 4 (see StabilisedMethod and Rock4Tableau).
#pragma once

#include "runtime/integrate/rock4_tableau.h"
#include "runtime/integrate/stabilised_method.h"

namespace tf::runtime {

class Rock4 final : public StabilisedMethod {
public:
  explicit Rock4(int size);

  [[nodiscard]] double border() const override { return rock4Tableaus().back().border; }
  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  [[nodiscard]] double errorOrder() const override { return 4; }
  [[nodiscard]] int interiorStages() const override { return tableau_->stages - 1; }

private:
  bool solveLast(ModeDynamics &dynamics, double t0);
  void estimateError();

  const Rock4Tableau *tableau_ = nullptr;
};

}  // namespace tf::runtime
