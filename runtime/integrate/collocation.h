// Nodes and weights of collocation methods on [0, 1] (Hairer, Wanner, Solving Ordinary Differential Equations II, IV.5).
#pragma once

#include <span>
#include <vector>

namespace tf::runtime {

// On [0, 1].
struct Quadrature {
  std::span<const double> nodes, weights;
};

// Weights w with Σ w_j p(x_j) = functional(p) for all polynomials of degree below the number of nodes; moments[k] = functional(x^k).
[[nodiscard]] std::vector<double> interpolatoryWeights(const std::vector<double> &nodes, const std::vector<long double> &moments);

// Moments of the integral from 0 to `end`, less gamma times the value at 0.
[[nodiscard]] std::vector<long double> integralMoments(int count, long double end, long double gamma = 0);

// a_ij of collocation at these nodes, row by row: the integrals from 0 to x_i of the polynomials that are 1 at x_j and 0 at the others.
[[nodiscard]] std::vector<double> collocationCoefficients(const std::vector<double> &nodes);

// Zeros of P_s − P_{s−1} (Legendre polynomials on [0, 1]), ascending, the last one 1; 1 ≤ stages ≤ 4.
[[nodiscard]] std::vector<double> radauNodes(int stages);

// The four zeros of P_4, ascending: order 8.
[[nodiscard]] std::vector<double> gaussNodes();

// Those and one near the end, inside the interval: order 8 too, A-stable, and |R(∞)| = (1 − c_5)/c_5 = 0.03 where that of the four is 1.
[[nodiscard]] std::vector<double> dampedGaussNodes();

}  // namespace tf::runtime
