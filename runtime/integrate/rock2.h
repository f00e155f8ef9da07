// The stabilised explicit method ROCK2 of order 2 (see StabilisedMethod and Rock2Tableau): for the same step it takes about a third fewer
// stages than ROCK4.
#pragma once

#include "runtime/integrate/rock2_tableau.h"
#include "runtime/integrate/stabilised_method.h"

namespace tf::runtime {

class Rock2 final : public StabilisedMethod {
public:
  explicit Rock2(int size);

  [[nodiscard]] double border() const override { return rock2Tableaus().back().border; }
  bool solve(ModeDynamics &dynamics, double t0, const double *y0, const double *f0, double h, const double *scale,
             double accuracy) override;
  [[nodiscard]] double errorOrder() const override { return 3; }
  [[nodiscard]] int interiorStages() const override { return tableau_->stages - 1; }

private:
  bool solveLast(ModeDynamics &dynamics, double t0);

  const Rock2Tableau *tableau_ = nullptr;
};

}  // namespace tf::runtime
