// Coefficients of the stabilised explicit Runge–Kutta methods ROCK4 of order 4 (Abdulle, Fourth order Chebyshev methods with recurrence
// relation, SIAM J. Sci. Comput. 23, 2002), one method for each of several numbers of stages: a recurrence (StabilisedTableau)
// and four stages. (The error estimate is another one than Abdulle's, whose embedded formula of order 3 sees hardly a tenth of the error of
// eigenvalues in the middle of long intervals.)
#pragma once

#include "runtime/integrate/stabilised_method.h"

#include <array>
#include <vector>

namespace tf::runtime {

// `border`: the stability polynomial is at most 0.96 for −border ≤ x ≤ −4.
struct Rock4Tableau : StabilisedTableau {
  static constexpr int lastStages = 4;

  // Of the last stages, which begin at the last g.
  std::array<std::array<double, lastStages - 1>, lastStages> weights{};
  std::array<double, lastStages> lastNode{};
  std::array<double, lastStages> result{};
  // Of the rates at the last g but one and at the last stages: an estimate of the error, of order 3.
  std::array<double, lastStages + 1> error{};
};

// By growing number of stages. Made when they are asked for first.
const std::vector<Rock4Tableau> &rock4Tableaus();

}  // namespace tf::runtime
