// Coefficients of the stabilised explicit Runge–Kutta methods ROCK4 of order 4 (Abdulle, Fourth order Chebyshev methods with recurrence
// relation, SIAM J. Sci. Comput. 23, 2002), one method for each of several numbers of stages.
//
// The stability polynomial is w(x) P(x), where w is positive of degree 4 and the P are orthogonal on [−length, −begin] with the weight
// w(x)²/√((x + length)(−begin − x)), so that P comes out of a recurrence of three terms, one evaluation each:
//     g_j = g_(j−1) + kappa_j (g_(j−1) − g_(j−2)) + h mu_j f(g_(j−1)),   j = 1 … recurrence,
// followed by four stages that give the order and the factor w. (The error estimate is another one than Abdulle's, whose embedded formula
// of order 3 sees hardly a tenth of the error of eigenvalues in the middle of long intervals.)
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace tf::runtime {

struct Rock4Tableau {
  static constexpr int lastStages = 4;

  int stages = 0;                       // evaluations of a step, the one at its end too
  double border = 0;                    // of stability: the polynomial is at most 0.96 for −border ≤ x ≤ −4
  std::vector<double> mu, kappa, node;  // [stages − 4]: of g_1, g_2, …; node: its time in parts of the step
  // Of the last stages, which begin at the last g.
  std::array<std::array<double, lastStages - 1>, lastStages> weights{};
  std::array<double, lastStages> lastNode{};
  std::array<double, lastStages> result{};
  // Of the rates at the last g but one and at the last stages: an estimate of the error, of order 3.
  std::array<double, lastStages + 1> error{};
};

// By growing number of stages. Made when they are asked for first.
const std::vector<Rock4Tableau> &rock4Tableaus();

// The one with the fewest stages that is stable for real eigenvalues λ with −border ≤ h λ ≤ 0; of the largest number where none is.
const Rock4Tableau &rock4TableauFor(double border);

}  // namespace tf::runtime
