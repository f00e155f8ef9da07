// Gauss–Legendre collocation of order 16 in long double with fixed-point iteration: an integrator that shares nothing with the project's
// own and whose error is far below theirs. Nodes and weights are computed, not tabulated.
#pragma once

#include <array>
#include <cmath>
#include <functional>

namespace tf::test {

using Number = long double;

class GaussTableau {
public:
  static constexpr int kStages = 8;

  [[nodiscard]] static const GaussTableau &instance() {
    static const GaussTableau tableau;
    return tableau;
  }

  std::array<Number, kStages> nodes{}, weights{};
  std::array<std::array<Number, kStages>, kStages> coefficients{};

private:
  GaussTableau() {
    const Number pi = std::acos(Number(-1));
    for (int i = 0; i < kStages; ++i) {
      Number x = -std::cos(pi * (i + Number(0.75)) / (kStages + Number(0.5))), derivative = 1;
      for (int iteration = 0; iteration < 20; ++iteration) {
        Number last = 1, value = x;
        for (int degree = 2; degree <= kStages; ++degree) {
          const Number next = ((2 * degree - 1) * x * value - (degree - 1) * last) / degree;
          last = value;
          value = next;
        }
        derivative = kStages * (x * value - last) / (x * x - 1);
        x -= value / derivative;
      }
      nodes[i] = (1 + x) / 2;
      weights[i] = 1 / ((1 - x * x) * derivative * derivative);
    }
    // a_ij = integral of the j-th Lagrange polynomial from 0 to c_i, by the quadrature rule itself (exact: degree 7 of 15).
    for (int i = 0; i < kStages; ++i) {
      for (int j = 0; j < kStages; ++j) {
        Number sum = 0;
        for (int k = 0; k < kStages; ++k) {
          sum += weights[k] * lagrange(j, nodes[i] * nodes[k]);
        }
        coefficients[i][j] = nodes[i] * sum;
      }
    }
  }

  [[nodiscard]] Number lagrange(int j, Number x) const {
    Number product = 1;
    for (int k = 0; k < kStages; ++k) {
      product *= k == j ? 1 : (x - nodes[k]) / (nodes[j] - nodes[k]);
    }
    return product;
  }
};

template <int N> using State = std::array<Number, N>;

// One step of y' = rhs(t, y).
template <int N, class Rhs> State<N> gaussStep(const Rhs &rhs, Number t, const State<N> &y, Number h) {
  constexpr int s = GaussTableau::kStages;
  const GaussTableau &tableau = GaussTableau::instance();
  std::array<State<N>, s> slopes;
  slopes.fill(rhs(t, y));
  for (int iteration = 0; iteration < 60; ++iteration) {
    Number change = 0;
    std::array<State<N>, s> next;
    for (int i = 0; i < s; ++i) {
      State<N> stage = y;
      for (int j = 0; j < s; ++j) {
        for (int n = 0; n < N; ++n) {
          stage[n] += h * tableau.coefficients[i][j] * slopes[j][n];
        }
      }
      next[i] = rhs(t + tableau.nodes[i] * h, stage);
      for (int n = 0; n < N; ++n) {
        change = std::max(change, std::abs(next[i][n] - slopes[i][n]));
      }
    }
    slopes = next;
    if (change < Number(1e-19)) {
      break;
    }
  }
  State<N> end = y;
  for (int i = 0; i < s; ++i) {
    for (int n = 0; n < N; ++n) {
      end[n] += h * tableau.weights[i] * slopes[i][n];
    }
  }
  return end;
}

// Integrates from t towards `end` in steps of h at most, until `stop(t, y)` changes its sign from positive; t and y are then those of the
// zero. True if that happened.
template <int N, class Rhs, class Stop> bool gaussUntil(const Rhs &rhs, const Stop &stop, Number &t, State<N> &y, Number end, Number h) {
  while (t < end) {
    const Number length = std::min(h, end - t);
    const State<N> next = gaussStep<N>(rhs, t, y, length);
    if (stop(t + length, next) < 0) {
      Number low = 0, high = length;
      for (int iteration = 0; iteration < 70; ++iteration) {
        const Number middle = (low + high) / 2;
        (stop(t + middle, gaussStep<N>(rhs, t, y, middle)) < 0 ? high : low) = middle;
      }
      y = gaussStep<N>(rhs, t, y, high);
      t += high;
      return true;
    }
    y = next;
    t = length == end - t ? end : t + length;
  }
  return false;
}

}  // namespace tf::test
