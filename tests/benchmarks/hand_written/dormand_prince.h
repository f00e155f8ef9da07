// Dormand–Prince 5(4) with dense output for small systems of fixed size (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations
// I, II.5 and II.6), written by hand as a yardstick for the compiled models.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace tf::hand_written {

template <int N> using Vector = std::array<double, N>;

// One accepted step: its ends and the coefficients of the continuous extension of order 4.
template <int N> struct DenseStep {
  double start = 0, length = 0;
  std::array<Vector<N>, 5> coefficients{};

  [[nodiscard]] Vector<N> at(double time) const {
    const double s = (time - start) / length;
    Vector<N> y{};
    for (int i = 0; i < N; ++i) {
      y[i] = coefficients[0][i] +
             s * (coefficients[1][i] + (1 - s) * (coefficients[2][i] + s * (coefficients[3][i] + (1 - s) * coefficients[4][i])));
    }
    return y;
  }
};

// y' = rhs(y), autonomous. The state is advanced by `step`; a refused step leaves it and shortens the next one.
template <int N, class Rhs> class DormandPrince {
public:
  DormandPrince(Rhs rhs, double time, const Vector<N> &y, double firstStep, double tolerance)
      : rhs_(rhs), time_(time), step_(firstStep), tolerance_(tolerance), y_(y), slope_(rhs(y)) {}

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] const Vector<N> &state() const { return y_; }
  [[nodiscard]] const DenseStep<N> &dense() const { return dense_; }
  [[nodiscard]] const Vector<N> &stepStart() const { return dense_.coefficients[0]; }

  // One accepted step, not beyond `end` and not longer than `longest`.
  void advance(double end, double longest) {
    for (;;) {
      const double h = std::min({step_, longest, end - time_});
      const double error = attempt(h);
      const double factor = error > 0 ? std::clamp(0.9 * std::pow(error, -0.2), 0.2, 10.0) : 10.0;
      if (error <= 1) {
        finish(h);
        time_ = h == end - time_ ? end : time_ + h;
        step_ = h < step_ ? std::max(step_, h * factor) : h * factor;
        return;
      }
      step_ = h * factor;
    }
  }

  // The solution at start + h from the start of the last step, to the full order of the method.
  [[nodiscard]] Vector<N> restep(double h) const {
    Stages k{};
    k[0] = firstSlope_;
    Vector<N> end{};
    stages(stepStart(), h, k, end);
    return end;
  }

private:
  using Stages = std::array<Vector<N>, 7>;

  static constexpr double A[6][6] = {{1.0 / 5},
                                     {3.0 / 40, 9.0 / 40},
                                     {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                     {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                     {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                     {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
  static constexpr double E[7] = {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
  static constexpr double D[7] = {-12715105075.0 / 11282082432,  0,
                                  87487479700.0 / 32700410799,   -10690763975.0 / 1880347072,
                                  701980252875.0 / 199316789632, -1453857185.0 / 822651844,
                                  69997945.0 / 29380423};

  void stages(const Vector<N> &y, double h, Stages &k, Vector<N> &end) const {
    for (int stage = 0; stage < 6; ++stage) {
      for (int i = 0; i < N; ++i) {
        double sum = 0;
        for (int j = 0; j <= stage; ++j) {
          sum += A[stage][j] * k[j][i];
        }
        end[i] = y[i] + h * sum;
      }
      if (stage < 5) {
        k[stage + 1] = rhs_(end);
      }
    }
  }

  double attempt(double h) {
    k_[0] = slope_;
    stages(y_, h, k_, end_);
    k_[6] = rhs_(end_);
    double error = 0;
    for (int i = 0; i < N; ++i) {
      double e = 0;
      for (int j = 0; j < 7; ++j) {
        e += E[j] * k_[j][i];
      }
      error = std::max(error, std::abs(h * e) / (tolerance_ * (1 + std::abs(end_[i]))));
    }
    return error;
  }

  void finish(double h) {
    dense_.start = time_;
    dense_.length = h;
    for (int i = 0; i < N; ++i) {
      const double difference = end_[i] - y_[i], bulge = h * k_[0][i] - difference;
      double last = 0;
      for (int j = 0; j < 7; ++j) {
        last += D[j] * k_[j][i];
      }
      dense_.coefficients[0][i] = y_[i];
      dense_.coefficients[1][i] = difference;
      dense_.coefficients[2][i] = bulge;
      dense_.coefficients[3][i] = difference - h * k_[6][i] - bulge;
      dense_.coefficients[4][i] = h * last;
    }
    firstSlope_ = k_[0];
    slope_ = k_[6];
    y_ = end_;
  }

  Rhs rhs_;
  double time_, step_, tolerance_;
  Vector<N> y_, slope_, end_{}, firstSlope_{};
  Stages k_{};
  DenseStep<N> dense_;
};

// The zero of `function` in [low, high], where it changes its sign: regula falsi with the Illinois modification.
template <class Function> double root(Function function, double low, double high, double atLow, double atHigh) {
  double middle = high;
  int lastSide = 0;
  for (int iteration = 0; iteration < 60 && high - low > 1e-15 * std::max(1.0, std::abs(high)); ++iteration) {
    middle = (low * atHigh - high * atLow) / (atHigh - atLow);
    const double atMiddle = function(middle);
    if (std::abs(atMiddle) < 1e-16) {
      break;
    }
    const bool replacesHigh = (atMiddle < 0) == (atHigh < 0);
    if (replacesHigh) {
      high = middle;
      atHigh = atMiddle;
      atLow *= lastSide > 0 ? 0.5 : 1.0;
    } else {
      low = middle;
      atLow = atMiddle;
      atHigh *= lastSide < 0 ? 0.5 : 1.0;
    }
    lastSide = replacesHigh ? 1 : -1;
  }
  return middle;
}

}  // namespace tf::hand_written
