// The stabilised explicit method ROCK4 of order 4 (see StabilisedMethod and Rock4Tableau).
#pragma once

#include "runtime/integrate/rock4_tableau.h"
#include "runtime/integrate/stabilised_method.h"

namespace tf::runtime {

class Rock4 final : public StabilisedMethod {
public:
  // Its elements are for this tolerance.
  Rock4(int size, double tolerance);

  [[nodiscard]] double border() const override { return rock4Tableaus().back().border; }
  [[nodiscard]] double errorOrder() const override { return 4; }

private:
  const StabilisedTableau &chooseTableau(double border) override { return *(tableau_ = &tableauFor(border, rock4Tableaus())); }
  bool solveLast(ModeDynamics &dynamics, double t0) override;
  void estimateError();

  const Rock4Tableau *tableau_ = nullptr;
};

}  // namespace tf::runtime
