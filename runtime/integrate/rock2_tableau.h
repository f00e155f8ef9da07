// Coefficients of the stabilised explicit Runge–Kutta methods ROCK2 of order 2 (Abdulle, Medovikov, Second order Chebyshev methods based on
// orthogonal polynomials, Numer. Math. 90, 2001), one method for each of several numbers of stages: a recurrence (StabilisedTableau) and
// two stages. (The error estimate is another one than theirs, which is of order 1.)
#pragma once

#include "runtime/integrate/stabilised_method.h"

#include <array>
#include <vector>

namespace tf::runtime {

// `border`: the stability polynomial is at most 0.96 for −border ≤ x ≤ −2.5.
struct Rock2Tableau : StabilisedTableau {
  static constexpr int lastStages = 2;

  double weight = 0;  // of the first of the last stages, which begin at the last g, in the second
  std::array<double, lastStages> lastNode{}, result{};
  // Of the rates at the last g but one and at the last stages: an estimate of the error, of order 2. Of eigenvalues far from zero, whose
  // motions have died out, it is larger than the error, but bounded.
  std::array<double, lastStages + 1> error{};
};

// By growing number of stages. Made when they are asked for first.
const std::vector<Rock2Tableau> &rock2Tableaus();

}  // namespace tf::runtime
