// What explicit Runge–Kutta methods have in common: stages, dense output and the test for stiffness (Hairer, Nørsett, Wanner, Solving
// Ordinary Differential Equations I, II.4–II.6). Tables are template arguments, so that sums over stages have no loops and no zeros.
#pragma once

#include "runtime/integrate/element_method.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

namespace tf::runtime {

class ExplicitMethod : public ElementMethod {
public:
  [[nodiscard]] double errorNorm(const double *scale, double tolerance) const override {
    return largestError(scale) / tolerance * std::max(1.0, powerError_ / (1 + 0.75 * powerError_ * distance_));
  }
  // Evaluations of the model in a step, and how far its stability reaches on the negative real axis.
  [[nodiscard]] int evaluations() const { return static_cast<int>(stageCount_); }
  [[nodiscard]] double stabilityBorder() const { return stabilityBorder_; }
  // Hairer, Wanner II, IV.2: two evaluations at the end of the step, whose states differ by the local error.
  [[nodiscard]] double stabilityRatio() const override;

protected:
  using Pair [[gnu::vector_size(16)]] = double;
  template <typename Entries> [[gnu::always_inline]] static Entries load(const double *from) {
    Entries entries;
    std::memcpy(&entries, from, sizeof entries);
    return entries;
  }
  [[gnu::always_inline]] static void store(double *to, Pair pair) { std::memcpy(to, &pair, sizeof pair); }

  // `stageCount`: those of the step, of which the last one is at its end; `storedCount`: all that are kept, the rate at the end and those
  // of the dense output with them. `stabilityBorder`: of the stability region, on the negative real axis. `powerError`: of the quadrature
  // of t^p over [0, 1] for p = 1/2, 3/2, 5/2, the most, in units of its estimate, or 1 where the estimate allows for such steps; over
  // [a, a + 1] it is 3/(4 a) and less.
  ExplicitMethod(int size, std::size_t stageCount, std::size_t storedCount, std::size_t coefficientCount, double stabilityBorder,
                 double powerError)
      : ElementMethod(size), stride_((static_cast<std::size_t>(size) + 1) / 2 * 2), stages_(stride_ * storedCount), point_(stride_),
        dense_(static_cast<std::size_t>(size) * coefficientCount), begin_(stride_), stageCount_(stageCount),
        stabilityBorder_(stabilityBorder), powerError_(powerError) {
    end_.resize(stride_);
    error_.resize(stride_);
  }

  // k_(s + 1), stride_ each.
  [[nodiscard]] double *stage(std::size_t s) { return stages_.data() + s * stride_; }
  [[nodiscard]] const double *stage(std::size_t s) const { return stages_.data() + s * stride_; }

  // The step from y0 with the rate f0, which is k1.
  void beginStep(const double *y0, const double *f0, double h);
  // Σ w_j k_j of one entry, or of two, over the stages of the sequence whose weight in a row of the table is not zero, in their order; `k`
  // is the entry of k_1, the stages are `stride` apart.
  template <typename Entries, const auto &table, std::size_t row, std::size_t... j>
  [[gnu::always_inline]] static Entries weightedSum(const double *k, std::size_t stride, std::index_sequence<j...> stages);
  // y = begin + h Σ weights_j k_j over the first `count` stages; y has stride_ entries.
  template <const auto &table, std::size_t row, std::size_t count> void combine(double *y);
  // Stage number `count`, out of those before it, with the row's node and weights.
  template <const auto &nodes, const auto &table, std::size_t row, std::size_t count> bool solveStage(ModeDynamics &dynamics, double t0) {
    combine<table, row, count>(point_.data());
    return dynamics.evaluate(t0 + nodes[row] * h_, point_.data(), stage(count));
  }
  // Stages 1 … of a table that has a row for each stage.
  template <const auto &nodes, const auto &table, std::size_t... s>
  bool solveStages(ModeDynamics &dynamics, double t0, std::index_sequence<s...> /*stages*/) {
    return (solveStage<nodes, table, s + 1, s + 1>(dynamics, t0) && ...);
  }

  // Coefficients of the dense output out of the first `count` stages: the cubic through both ends, and one for each row of the table (zero
  // without it).
  template <const auto &table, std::size_t count, std::size_t... row>
  void makeCoefficients(bool withTable, std::index_sequence<row...> rows);
  // y0 + theta (c0 + (1 − theta) (c1 + theta (c2 + (1 − theta) (c3 + …
  template <std::size_t count> void evaluateDense(double theta, double *y) const;
  // The derivative of entry i by theta.
  template <std::size_t count> [[nodiscard]] double denseSlope(double theta, int i) const;

  // Sums over stages take two entries at a time: arrays are padded by zeros.
  std::size_t stride_;
  std::vector<double> stages_, point_, dense_;
  bool hasDense_ = false;  // the coefficients of the dense output, which are made when they are asked for
  std::vector<double> begin_;
  double h_ = 0;

private:
  std::size_t stageCount_;
  double stabilityBorder_, powerError_;
};

template <typename Entries, const auto &table, std::size_t row, std::size_t... j>
inline Entries ExplicitMethod::weightedSum(const double *k, std::size_t stride, std::index_sequence<j...> /*stages*/) {
  Entries sum = {};
  const auto add = [&]<std::size_t number>(std::integral_constant<std::size_t, number>) {
    if constexpr (table[row][number] != 0)
      sum += table[row][number] * load<Entries>(k + number * stride);
  };
  (add(std::integral_constant<std::size_t, j>{}), ...);
  return sum;
}

template <const auto &table, std::size_t row, std::size_t count> void ExplicitMethod::combine(double *y) {
  const double h = h_, *k = stages_.data(), *begin = begin_.data();
  const std::size_t stride = stride_;
  for (std::size_t i = 0; i < stride; i += 2)
    store(y + i, load<Pair>(begin + i) + h * weightedSum<Pair, table, row>(k + i, stride, std::make_index_sequence<count>()));
}

template <const auto &table, std::size_t count, std::size_t... row>
void ExplicitMethod::makeCoefficients([[maybe_unused]] bool withTable, std::index_sequence<row...> /*rows*/) {
  double *c = dense_.data();
  for (int i = 0; i < n_; ++i, c += 3 + sizeof...(row)) {
    const double *k = stages_.data() + i;
    c[0] = end_[i] - begin_[i];
    c[1] = h_ * *k - c[0];
    c[2] = c[0] - h_ * endRate_[i] - c[1];
    ((c[3 + row] = withTable ? h_ * weightedSum<double, table, row>(k, stride_, std::make_index_sequence<count>()) : 0), ...);
  }
  hasDense_ = true;
}

template <std::size_t count> void ExplicitMethod::evaluateDense(double theta, double *y) const {
  const double rest = 1 - theta;
  for (int i = 0; i < n_; ++i) {
    const double *c = dense_.data() + static_cast<std::size_t>(i) * count;
    double value = c[count - 1];
    for (std::size_t k = count - 1; k-- > 0;)
      value = c[k] + (k % 2 == 0 ? rest : theta) * value;
    y[i] = begin_[i] + theta * value;
  }
}

template <std::size_t count> double ExplicitMethod::denseSlope(double theta, int i) const {
  const double *c = dense_.data() + static_cast<std::size_t>(i) * count;
  double value = c[count - 1], slope = 0;
  for (std::size_t k = count - 1; k-- > 0;) {
    const double factor = k % 2 == 0 ? 1 - theta : theta, change = k % 2 == 0 ? -1 : 1;
    slope = change * value + factor * slope;
    value = c[k] + factor * value;
  }
  return value + theta * slope;
}

}  // namespace tf::runtime
